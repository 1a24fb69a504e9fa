// Two versions of maps, laid on each other: what is a wall in one alone, and what only one has seen.
import { html, nothing } from 'lit-html';
import { ref } from 'lit-html/directives/ref.js';
import { compared, KINDS } from '../../map/compare.js';
import { inSight } from '../../parts/in-sight.js';
import { t } from '../../texts/texts.js';
import { fetched } from './stored-picture.js';

/** @typedef {import('../../app.js').App} App */
/** @typedef {{ name: string, version: number }} Entry */

const COLOURS = /** @type {Record<typeof KINDS[number], string>} */ ({
  unseen: '--map-unknown', free: '--map-free', wall: '--map-wall', wall_first: '--map-against', wall_second: '--accent', seen_first: '--compare-first', seen_second: '--compare-second',
});
/** @type {Entry[]} */
let chosen = [];
/** @type {ReturnType<typeof compared> | null} */
let result = null;

/** @param {Entry} entry */
export const isChosen = (entry) => chosen.some((one) => isSame(one, entry));

/** @param {Entry} one @param {Entry} other */
const isSame = (one, other) => one.name === other.name && one.version === other.version;

/** Choose a version, or no longer; with two chosen, they are compared. @param {App} app @param {Entry} entry */
export async function choose(app, entry) {
  chosen = isChosen(entry) ? chosen.filter((one) => !isSame(one, entry)) : [...chosen.slice(-1), { name: entry.name, version: entry.version }];
  result = null;
  app.wake(true);
  const [one, other] = chosen;
  if (one === undefined || other === undefined) return;
  const pair = chosen;
  try {
    const both = await Promise.all([fetched(one), fetched(other)]);
    if (pair === chosen) result = compared(...both);
  } catch (error) {
    app.notice('refused', t('refused', { message: error instanceof Error ? error.message : String(error) }));
  }
  app.wake(true);
}

/** @param {App} app */
export function comparison(app) {
  const [one, other] = chosen;
  if (one === undefined) return nothing;
  const end = () => { chosen = []; result = null; app.wake(true); };
  const label = (/** @type {Entry} */ entry) => `${entry.name} ${entry.version}`;
  if (other === undefined) return html`<section class="card bench"><p>${t('compare.one', { name: label(one) })}</p><button @click=${end}>${t('cancel')}</button></section>`;
  const found = result;
  return html`<section class="card bench" ${ref(inSight)} aria-label=${t('compare.title', { first: label(one), second: label(other) })}>
    <h2 class="name">${t('compare.title', { first: label(one), second: label(other) })}</h2>
    ${found === null ? html`<p>${t('compare.under_way')}</p>` : html`
      <canvas class="picture" role="img" aria-label=${t('compare.title', { first: label(one), second: label(other) })} ${ref((element) => paint(element, found))}></canvas>
      <ul class="legend">${KINDS.map((kind, index) => kind === 'unseen' ? nothing : html`<li><span class=${`swatch compare-${kind}`}></span>${t(`compare.${kind}`, { first: label(one), second: label(other) })}: <span class="value">${t('compare.area', { area: ((found.counts[index] ?? 0) * found.resolution_m ** 2).toFixed(2) })}</span></li>`)}</ul>`}
    <button @click=${end}>${t('close')}</button></section>`;
}

/** @type {WeakMap<Element, object>} */
const painted = new WeakMap();

/** @param {Element | undefined} element @param {ReturnType<typeof compared>} found */
function paint(element, found) {
  if (!(element instanceof HTMLCanvasElement) || painted.get(element) === found) return;
  painted.set(element, found);
  const { rows, cols, kinds } = found;
  [element.width, element.height] = [cols, rows];
  const context = element.getContext('2d');
  if (context === null) return;
  const style = getComputedStyle(document.documentElement); // the picture itself is not on the page yet
  const table = KINDS.map((kind) => pixelOf(style.getPropertyValue(COLOURS[kind]).trim()));
  const image = context.createImageData(cols, rows);
  const pixels = new Uint32Array(image.data.buffer);
  for (let row = 0; row < rows; row++) {
    for (let col = 0; col < cols; col++) pixels[(rows - 1 - row) * cols + col] = table[kinds[row * cols + col] ?? 0] ?? 0;
  }
  context.putImageData(image, 0, 0);
}

/** `#rrggbb` as the bytes of a picture have it. @param {string} colour */
function pixelOf(colour) {
  const number = Number.parseInt(colour.slice(1, 7), 16) || 0;
  return (0xff000000 | ((number & 255) << 16) | (number & 0xff00) | (number >> 16)) >>> 0;
}
