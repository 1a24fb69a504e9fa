// What of the map is seen: a place in the middle, and pixels for each metre. Pure.

/** @typedef {{ x: number, y: number, scale: number }} View */

const LEAST = 2;
const MOST = 2000;

/** @param {number} scale */
const within = (scale) => Math.min(MOST, Math.max(LEAST, scale));

/**
 * Return the place of the map below a pixel.
 * @param {View} view @param {{ width: number, height: number }} size @param {number} px @param {number} py
 */
export function toMap(view, size, px, py) {
  return { x: view.x + (px - size.width / 2) / view.scale, y: view.y - (py - size.height / 2) / view.scale };
}

/** @param {View} view @param {{ width: number, height: number }} size @param {number} x @param {number} y */
export function toPixel(view, size, x, y) {
  return { px: size.width / 2 + (x - view.x) * view.scale, py: size.height / 2 - (y - view.y) * view.scale };
}

/** Zoom, the place below a pixel staying where it is. @param {View} view @param {{ width: number, height: number }} size @param {number} factor @param {number} px @param {number} py */
export function zoomed(view, size, factor, px, py) {
  const scale = within(view.scale * factor);
  const before = toMap(view, size, px, py);
  const after = toMap({ ...view, scale }, size, px, py);
  return { x: view.x + before.x - after.x, y: view.y + before.y - after.y, scale };
}

/** @param {View} view @param {number} dx pixels @param {number} dy pixels */
export function panned(view, dx, dy) {
  return { ...view, x: view.x - dx / view.scale, y: view.y + dy / view.scale };
}

/**
 * Return the view that shows all of a rectangle.
 * @param {{ x0: number, y0: number, x1: number, y1: number }} box metres @param {{ width: number, height: number }} size
 */
export function fitted(box, size) {
  const across = Math.max(box.x1 - box.x0, 0.5), up = Math.max(box.y1 - box.y0, 0.5);
  return { x: (box.x0 + box.x1) / 2, y: (box.y0 + box.y1) / 2, scale: within(0.92 * Math.min(size.width / across, size.height / up)) };
}

/**
 * Return the rectangle of the cells that somebody saw; all of them if nobody saw any.
 * @param {import('./grid.js').Placement} place @param {Uint8Array} cells
 */
export function seen(place, cells) {
  let r0 = place.rows, r1 = -1, c0 = place.cols, c1 = -1;
  for (let row = 0; row < place.rows; row++) {
    for (let col = 0; col < place.cols; col++) {
      if (cells[row * place.cols + col] === 128) continue;
      r0 = Math.min(r0, row); r1 = row; c0 = Math.min(c0, col); c1 = Math.max(c1, col);
    }
  }
  if (r1 < 0) [r0, r1, c0, c1] = [0, place.rows - 1, 0, place.cols - 1];
  const { origin_x_m: x, origin_y_m: y, resolution_m: side } = place;
  return { x0: x + c0 * side, y0: y + r0 * side, x1: x + (c1 + 1) * side, y1: y + (r1 + 1) * side };
}
