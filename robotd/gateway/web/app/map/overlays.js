// Pictures that lie over the map: how many readings each place explains, and where the robot's disk does not fit.
import { unpacked } from './grid.js';

/** @typedef {{ picture: OffscreenCanvas, rows: number, cols: number, resolution_m: number, origin_x_m: number, origin_y_m: number }} Overlay */

const AGAIN_MS = 1000;
const WALL = 128;

/**
 * Return a picture of pixels whose first row is the lowest y, turned as pictures are.
 * @param {number} rows @param {number} cols @param {(cell: number) => number} colour as 0xAABBGGRR
 */
function pictured(rows, cols, colour) {
  const picture = new OffscreenCanvas(cols, rows);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (picture.getContext('2d'));
  const image = context.createImageData(cols, rows);
  const pixels = new Uint32Array(image.data.buffer);
  for (let row = 0; row < rows; row++) {
    for (let col = 0; col < cols; col++) pixels[(rows - 1 - row) * cols + col] = colour(row * cols + col);
  }
  context.putImageData(image, 0, 0);
  return picture;
}

/** Draw an overlay. @param {import('./layers.js').Context} context whose unit is the metre @param {Overlay} overlay */
export function drawOverlay(context, overlay) {
  const { rows, resolution_m: side } = overlay;
  context.save();
  context.imageSmoothingEnabled = false;
  context.translate(overlay.origin_x_m, overlay.origin_y_m + rows * side);
  context.scale(side, -side);
  context.drawImage(overlay.picture, 0, 0);
  context.restore();
}

/** The heat map of a `rank_map`: the more readings a place explains, the more of the colour. @param {any} fields @returns {Promise<Overlay>} */
export async function rankOverlay(fields) {
  const { rows, cols, resolution_m, origin_x_m, origin_y_m } = fields;
  const levels = await unpacked(fields.levels_zlib, rows * cols);
  // From a quarter of the readings on: below that nearly every place is alike.
  const picture = pictured(rows, cols, (cell) => {
    const share = Math.max(0, ((levels[cell] ?? 0) / 255 - 0.25) / 0.75);
    return ((Math.round(235 * share ** 1.2) << 24) | (0x54 << 16) | (0xb4 << 8) | 0xff) >>> 0;
  });
  return { picture, rows, cols, resolution_m, origin_x_m, origin_y_m };
}

/**
 * Return how far each cell is from the nearest that is no free ground [cells], by steps and knight's moves: within 2 %.
 * @param {Uint8Array} cells @param {number} rows @param {number} cols
 */
export function distances(cells, rows, cols) {
  const straight = 5;
  const downs = [0, -1, -1, -1, -1, -1, -2, -2], rights = [-1, 0, -1, 1, -2, 2, -1, 1], lengths = [straight, straight, 7, 7, 11, 11, 11, 11];
  const far = new Uint16Array(rows * cols).fill(65000);
  for (let cell = 0; cell < far.length; cell++) if ((cells[cell] ?? WALL) >= WALL) far[cell] = 0;
  // Plain loops: this is done on the thread that answers for the page.
  for (let sign = 1; sign >= -1; sign -= 2) {
    for (let n = 0; n < rows; n++) {
      const row = sign === 1 ? n : rows - 1 - n;
      for (let m = 0; m < cols; m++) {
        const col = sign === 1 ? m : cols - 1 - m, cell = row * cols + col;
        let least = /** @type {number} */ (far[cell]);
        if (least === 0) continue;
        for (let step = 0; step < 8; step++) {
          const r = row + sign * /** @type {number} */ (downs[step]), c = col + sign * /** @type {number} */ (rights[step]);
          if (r < 0 || c < 0 || r >= rows || c >= cols) continue;
          const there = /** @type {number} */ (far[r * cols + c]) + /** @type {number} */ (lengths[step]);
          if (there < least) least = there;
        }
        far[cell] = least;
      }
    }
  }
  return Float32Array.from(far, (one) => one / straight);
}

/** Where the robot's disk would touch what is no free ground; made again when the map has changed, once a second at most. */
export class Clearance {
  /** @type {Overlay | null} */
  overlay = null;
  #version = -1;
  #at = -Infinity;

  /** @param {import('./grid.js').Grid} grid @param {number} radius metres @param {number} now */
  look(grid, radius, now) {
    const place = grid.placement;
    if (place === null) return (this.overlay = null);
    if (grid.version !== this.#version && now - this.#at > AGAIN_MS) {
      this.#version = grid.version;
      this.#at = now;
      const far = distances(grid.cells, place.rows, place.cols), least = radius / place.resolution_m;
      const picture = pictured(place.rows, place.cols, (cell) => ((far[cell] ?? 0) > 0 && (far[cell] ?? 0) < least ? 0x66_5c_9d_ff : 0));
      this.overlay = { picture, ...place };
    }
    return this.overlay;
  }
}
