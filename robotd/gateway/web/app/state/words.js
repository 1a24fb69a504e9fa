// How the robot stands, as one word with a mark of its own shape.

/** @typedef {import('../types').State} State */

/**
 * Return the word for where the robot is, and the mark beside it.
 * @param {State} state
 * @returns {{ word: string, places: number, mark: 'circle' | 'ring' | 'diamond' | 'cross' | 'square' }}
 */
export function whereabouts(state) {
  const { status, pose } = state;
  if (status === null) return { word: 'unknown', places: 0, mark: 'square' };
  if (status.map_id === null) return { word: 'no_map', places: 0, mark: 'square' };
  if (pose === null) return { word: 'lost', places: 0, mark: 'cross' };
  const marks = /** @type {const} */ ({ localized: 'circle', predicted: 'ring', ambiguous: 'diamond', lost: 'cross' });
  const state_ = /** @type {keyof typeof marks} */ (pose.state);
  return { word: pose.state, places: pose.regions.length + (pose.regions_left_out ?? 0), mark: marks[state_] ?? 'square' };
}

/** Whether somebody else than this page drives. @param {State} state */
export function isWatching(state) {
  const { commander, hello, status } = state;
  if (commander !== null) return commander.driver.browser !== hello?.browser;
  return status?.mission_id != null;
}

/** Whether this page drives. @param {State} state */
export function isDriving(state) {
  return state.commander !== null && state.commander.driver.browser === state.hello?.browser;
}
