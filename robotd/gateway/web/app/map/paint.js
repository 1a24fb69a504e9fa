// Cells to colours. Pure: into the pixels of a picture whose first row is the highest y.
import { SIDE } from './grid.js';

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

/**
 * Where a tile lies, in cells.
 * @param {number} tile @param {{ rows: number, cols: number }} place
 */
export function boundsOf(tile, place) {
  const across = Math.ceil(place.cols / SIDE);
  const row = Math.floor(tile / across) * SIDE, col = (tile % across) * SIDE;
  return { row, col, height: Math.min(SIDE, place.rows - row), width: Math.min(SIDE, place.cols - col) };
}

/**
 * Paint a tile.
 * @param {Uint32Array} pixels of it, `height * width`
 * @param {Uint8Array} cells of the whole map
 * @param {number} cols of the whole map
 * @param {{ row: number, col: number, height: number, width: number }} bounds
 * @param {Uint32Array} table
 */
export function paint(pixels, cells, cols, bounds, table) {
  let pixel = 0;
  for (let row = bounds.row + bounds.height - 1; row >= bounds.row; row--) {
    const from = row * cols + bounds.col;
    for (let cell = from; cell < from + bounds.width; cell++) pixels[pixel++] = table[cells[cell] ?? 128] ?? 0;
  }
}
