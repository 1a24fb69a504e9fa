// Two maps laid on each other: what each says of every place. Pure.

/** @typedef {import('../pages/maps/stored-picture.js').StoredPicture} StoredPicture */

const UNSEEN = 128;
/** What two maps say of a place, in the order of the colours: unseen by both, both free, both wall, a wall of the first or the second alone, seen by the first or the second alone. */
export const KINDS = /** @type {const} */ (['unseen', 'free', 'wall', 'wall_first', 'wall_second', 'seen_first', 'seen_second']);

/**
 * Return, for each cell of the box round both, an index of KINDS; cells are as large as the smaller ones of the two.
 * @param {StoredPicture} first @param {StoredPicture} second
 */
export function compared(first, second) {
  const side = Math.min(first.resolution_m, second.resolution_m);
  const x = Math.min(first.origin_x_m, second.origin_x_m), y = Math.min(first.origin_y_m, second.origin_y_m);
  const cols = Math.round((Math.max(right(first), right(second)) - x) / side), rows = Math.round((Math.max(top(first), top(second)) - y) / side);
  const kinds = new Uint8Array(rows * cols);
  const counts = KINDS.map(() => 0);
  for (let row = 0; row < rows; row++) {
    for (let col = 0; col < cols; col++) {
      const at = /** @type {const} */ ([x + (col + 0.5) * side, y + (row + 0.5) * side]);
      const kind = kindOf(valueAt(first, ...at), valueAt(second, ...at));
      kinds[row * cols + col] = kind;
      counts[kind] = (counts[kind] ?? 0) + 1;
    }
  }
  return { rows, cols, kinds, counts, resolution_m: side };
}

/** @param {number} one @param {number} other */
function kindOf(one, other) {
  if (one === UNSEEN && other === UNSEEN) return 0;
  if (one > UNSEEN && other > UNSEEN) return 2;
  if (one > UNSEEN) return 3;
  if (other > UNSEEN) return 4;
  if (one === UNSEEN) return 6;
  return other === UNSEEN ? 5 : 1;
}

/** @param {StoredPicture} map */
const right = (map) => map.origin_x_m + map.cols * map.resolution_m;
/** @param {StoredPicture} map */
const top = (map) => map.origin_y_m + map.rows * map.resolution_m;

/** @param {StoredPicture} map @param {number} x @param {number} y */
function valueAt(map, x, y) {
  const col = Math.floor((x - map.origin_x_m) / map.resolution_m), row = Math.floor((y - map.origin_y_m) / map.resolution_m);
  return col < 0 || row < 0 || col >= map.cols || row >= map.rows ? UNSEEN : (map.cells[row * map.cols + col] ?? UNSEEN);
}
