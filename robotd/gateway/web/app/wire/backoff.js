// When to try again: 0.25 to 5 s, twice as long each time, with jitter so that pages do not come all at once.

const LEAST_MS = 250;
const MOST_MS = 5000;

/**
 * Return how long to wait before a try.
 * @param {number} failed how many tries failed in a row, from 0
 * @param {number} random from 0 to 1
 */
export function waitMs(failed, random) {
  return Math.min(MOST_MS, LEAST_MS * 2 ** failed) * (0.75 + 0.5 * random);
}
