// The map as pictures of 512 x 512 cells: those that are seen are painted, where a cell changed, a few at a time.
import { boundsOf, colours, paint } from './paint.js';
import { SIDE } from './grid.js';

/** How long painting may hold up a frame. */
const AT_ONCE_MS = 6;

export class Tiles {
  /** Pictures that nobody can change, which are drawn without being copied. @type {Map<number, ImageBitmap>} */
  #pictures = new Map();
  /** @type {import('./grid.js').Placement | null} */
  #placement = null;
  #table = new Uint32Array(256);
  /** Where each is painted. */
  #easel = new OffscreenCanvas(SIDE, SIDE);

  /** @param {import('./grid.js').Grid} grid */
  constructor(grid) {
    this.grid = grid;
  }

  /** Paint everything again in these colours. @param {import('./paint.js').Palette} palette */
  recolour(palette) {
    this.#table = colours(palette);
    this.#placement = null;
  }

  /**
   * Draw what lies in a box of the map; return whether some of it is still to be painted.
   * @param {OffscreenCanvasRenderingContext2D} context whose unit is the metre @param {{ x0: number, y0: number, x1: number, y1: number }} box
   */
  draw(context, box) {
    const place = this.grid.placement;
    if (place === null) return false;
    if (place !== this.#placement) {
      for (const picture of this.#pictures.values()) picture.close();
      this.#pictures.clear();
      this.#placement = place;
    }
    const begun = performance.now();
    let isUnfinished = false;
    // In whole pixels of the screen: no seam between two tiles.
    const { a, d, e, f } = context.getTransform();
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.imageSmoothingEnabled = a * place.resolution_m < 1; // else walls would come and go with each step
    for (const tile of tilesIn(place, box)) {
      if (!this.#pictures.has(tile) || this.grid.dirty.has(tile)) {
        if (performance.now() - begun < AT_ONCE_MS) this.#paint(tile, place);
        else isUnfinished = true;
      }
      const picture = this.#pictures.get(tile);
      if (picture === undefined) continue;
      const { row, col, height, width } = boundsOf(tile, place);
      const across = (/** @type {number} */ cells) => Math.round(a * (place.origin_x_m + cells * place.resolution_m) + e);
      const down = (/** @type {number} */ cells) => Math.round(d * (place.origin_y_m + cells * place.resolution_m) + f);
      const left = across(col), top = down(row + height);
      context.drawImage(picture, 0, 0, width, height, left, top, across(col + width) - left, down(row) - top);
    }
    context.restore();
    return isUnfinished;
  }

  /** @param {number} tile @param {import('./grid.js').Placement} place */
  #paint(tile, place) {
    const bounds = boundsOf(tile, place);
    const context = this.#easel.getContext('2d', { alpha: false });
    if (context === null) return;
    const image = context.createImageData(bounds.width, bounds.height);
    paint(new Uint32Array(image.data.buffer), this.grid.cells, place.cols, bounds, this.#table);
    context.putImageData(image, 0, 0);
    this.#pictures.get(tile)?.close();
    this.#pictures.set(tile, this.#easel.transferToImageBitmap());
    this.grid.dirty.delete(tile);
  }
}

/**
 * Return the tiles that lie in a box of the map, those in its middle first.
 * @param {import('./grid.js').Placement} place @param {{ x0: number, y0: number, x1: number, y1: number }} box
 */
export function tilesIn(place, box) {
  const side = SIDE * place.resolution_m;
  const across = Math.ceil(place.cols / SIDE), up = Math.ceil(place.rows / SIDE);
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
