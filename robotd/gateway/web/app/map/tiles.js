// The map as pictures of 512 x 512 pixels, each of 1 x 1 cells, or of 2 x 2, 4 x 4 and so on where the screen has no more
// pixels than that. Those that are seen are painted when they are first seen and where a cell changed, a few at a time.
import { SIDE } from './grid.js';
import { boundsOf, paint } from './paint.js';

/** @typedef {{ x0: number, y0: number, x1: number, y1: number }} Box metres */
/** @typedef {import('./grid.js').Placement} Placement */

/** How long painting may hold up a frame. */
const AT_ONCE_MS = 30;
/** Pictures kept: what was seen of late, at this scale or another. */
const KEPT = 256;

export class Tiles {
  /** Pictures that cannot change, which are drawn without being copied, and the version of the map that each shows. @type {Map<string, { picture: ImageBitmap, version: number }>} */
  #painted = new Map();
  /** @type {Placement | null} */
  #placement = null;
  /** @type {Uint32Array} */
  #table = new Uint32Array(256);
  /** Where each is painted. */
  #easel = new OffscreenCanvas(SIDE, SIDE);

  /** @param {import('./grid.js').Grid} grid */
  constructor(grid) {
    this.grid = grid;
  }

  /** Paint everything again in these colours. @param {Uint32Array} table of the 256 values */
  recolour(table) {
    this.#table = table;
    this.#forget();
  }

  /**
   * Draw what lies in a box of the map; return whether some of it is still to be painted.
   * @param {OffscreenCanvasRenderingContext2D} context whose unit is the metre @param {Box} box
   */
  draw(context, box) {
    const place = this.grid.placement;
    if (place !== this.#placement) this.#forget();
    this.#placement = place;
    if (place === null) return false;
    const begun = performance.now();
    let isUnfinished = false;
    // In whole pixels of the screen: no seam between two tiles.
    const { a, d, e, f } = context.getTransform();
    const level = levelOf(a * place.resolution_m);
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.imageSmoothingEnabled = false;
    for (const tile of tilesIn(place, level, box)) {
      const bounds = boundsOf(tile, level, place), { row, col, block } = bounds;
      const mayPaint = performance.now() - begun < AT_ONCE_MS;
      const { picture, isOld } = this.#picture(`${level} ${tile}`, bounds, place, mayPaint);
      isUnfinished ||= isOld;
      if (picture === null) continue;
      const high = Math.ceil(bounds.height / block), wide = Math.ceil(bounds.width / block);
      const across = (/** @type {number} */ cells) => Math.round(a * (place.origin_x_m + cells * place.resolution_m) + e);
      const down = (/** @type {number} */ cells) => Math.round(d * (place.origin_y_m + cells * place.resolution_m) + f);
      const left = across(col), top = down(row + high * block);
      context.drawImage(picture, 0, 0, wide, high, left, top, across(col + wide * block) - left, down(row) - top);
    }
    context.restore();
    return isUnfinished;
  }

  #forget() {
    for (const { picture } of this.#painted.values()) picture.close();
    this.#painted.clear();
  }

  /** The picture of a tile, as new as may be; null if it was never painted. @param {string} name @param {import('./paint.js').Bounds} bounds @param {Placement} place @param {boolean} mayPaint */
  #picture(name, bounds, place, mayPaint) {
    const before = this.#painted.get(name);
    const isOld = before === undefined || this.#changedAt(bounds, place) > before.version;
    if (!isOld || !mayPaint) return { picture: before?.picture ?? null, isOld };
    const context = this.#easel.getContext('2d', { alpha: false });
    if (context === null) return { picture: null, isOld: false };
    const image = context.createImageData(Math.ceil(bounds.width / bounds.block), Math.ceil(bounds.height / bounds.block));
    paint(new Uint32Array(image.data.buffer), this.grid.cells, place.cols, bounds, this.#table);
    context.putImageData(image, 0, 0);
    before?.picture.close();
    const picture = this.#easel.transferToImageBitmap();
    this.#painted.delete(name);
    this.#painted.set(name, { picture, version: this.grid.version });
    this.#keepFew();
    return { picture, isOld: false };
  }

  #keepFew() {
    const [oldest] = this.#painted;
    if (this.#painted.size <= KEPT || oldest === undefined) return;
    oldest[1].picture.close();
    this.#painted.delete(oldest[0]);
  }

  /** At which version a cell of a tile of any level changed last. @param {import('./paint.js').Bounds} bounds @param {Placement} place */
  #changedAt({ row, col, height, width }, place) {
    const across = Math.ceil(place.cols / SIDE);
    let last = 0;
    for (let r = row / SIDE; r < (row + height) / SIDE; r++) {
      for (let c = col / SIDE; c < (col + width) / SIDE; c++) last = Math.max(last, this.grid.tileVersion(r * across + c));
    }
    return last;
  }
}

/** Return the level at which a pixel of a picture is no smaller than one of the screen. @param {number} px of the screen for each cell */
export function levelOf(px) {
  return Math.max(0, Math.min(6, Math.ceil(-Math.log2(px))));
}

/**
 * Return the tiles of a level that lie in a box of the map, those in its middle first.
 * @param {Placement} place @param {number} level @param {Box} box
 */
export function tilesIn(place, level, box) {
  const cells = SIDE << level, side = cells * place.resolution_m;
  const across = Math.ceil(place.cols / cells), up = Math.ceil(place.rows / cells);
  const clamp = (/** @type {number} */ value, /** @type {number} */ count) => Math.min(count, Math.max(0, value));
  const c0 = clamp(Math.floor((box.x0 - place.origin_x_m) / side), across), c1 = clamp(Math.ceil((box.x1 - place.origin_x_m) / side), across);
  const r0 = clamp(Math.floor((box.y0 - place.origin_y_m) / side), up), r1 = clamp(Math.ceil((box.y1 - place.origin_y_m) / side), up);
  /** @type {{ tile: number, far: number }[]} */
  const found = [];
  for (let row = r0; row < r1; row++) {
    for (let col = c0; col < c1; col++) found.push({ tile: row * across + col, far: Math.hypot(row - (r0 + r1 - 1) / 2, col - (c0 + c1 - 1) / 2) });
  }
  return found.sort((one, other) => one.far - other.far).map(({ tile }) => tile);
}
