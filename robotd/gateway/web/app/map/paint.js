// Cells to colours. Pure: into the pixels of a picture whose first row is the highest y.
import { SIDE } from './grid.js';

const UNSEEN = 128;

/** @typedef {[number, number, number]} Colour */

/** @typedef {{ free: Colour, wall: Colour, unknown: Colour }} Palette */

/**
 * Return the 256 colours of cells: from free over unknown to wall.
 * @param {Palette} palette
 */
export function colours(palette) {
  const table = new Uint32Array(256);
  const bytes = new Uint8Array(table.buffer);
  for (let value = 0; value < 256; value++) {
    const share = value < 128 ? (128 - value) / 128 : (value - 128) / 127;
    const end = value < 128 ? palette.free : palette.wall;
    // The first doubts are drawn boldly: a cell seen once is a cell that was seen.
    const weight = value === 128 ? 0 : 0.35 + 0.65 * share;
    for (let part = 0; part < 3; part++) {
      bytes[4 * value + part] = Math.round((palette.unknown[part] ?? 0) * (1 - weight) + (end[part] ?? 0) * weight);
    }
    bytes[4 * value + 3] = 255;
  }
  return table;
}

/** @typedef {{ row: number, col: number, height: number, width: number, block: number }} Bounds cells; each pixel is a block of so many of them along each side */

/**
 * Where a tile of a level lies: 512 x 512 pixels, of 1 x 1 cells at level 0, of 2 x 2 at level 1, and so on.
 * @param {number} tile @param {number} level @param {{ rows: number, cols: number }} place @returns {Bounds}
 */
export function boundsOf(tile, level, place) {
  const block = 1 << level, side = SIDE * block;
  const across = Math.ceil(place.cols / side);
  const row = Math.floor(tile / across) * side, col = (tile % across) * side;
  return { row, col, height: Math.min(side, place.rows - row), width: Math.min(side, place.cols - col), block };
}

/**
 * Paint a tile: of each block its wall, if it has one, else what is most surely free, so that no wall is lost.
 * @param {Uint32Array} pixels of it, a row of blocks after the other, the highest y first
 * @param {Uint8Array} cells of the whole map
 * @param {number} cols of the whole map
 * @param {Bounds} bounds
 * @param {Uint32Array} table
 */
export function paint(pixels, cells, cols, { row, col, height, width, block }, table) {
  let pixel = 0;
  for (let top = Math.ceil(height / block) - 1; top >= 0; top--) {
    for (let left = 0; left < width; left += block) {
      const value = block === 1 ? cells[(row + top) * cols + col + left] : blockOf(cells, cols, row + top * block, Math.min(row + height, row + (top + 1) * block), col + left, col + Math.min(width, left + block));
      pixels[pixel++] = /** @type {number} */ (table[/** @type {number} */ (value)]);
    }
  }
}

/** What a block is painted as. @param {Uint8Array} cells @param {number} cols @param {number} r0 @param {number} r1 @param {number} c0 @param {number} c1 */
export function blockOf(cells, cols, r0, r1, c0, c1) {
  let least = UNSEEN, most = UNSEEN;
  for (let row = r0; row < r1; row++) {
    for (let cell = row * cols + c0; cell < row * cols + c1; cell++) {
      const value = /** @type {number} */ (cells[cell]);
      if (value > most) most = value;
      else if (value < least) least = value;
    }
  }
  return most > UNSEEN ? most : least;
}
