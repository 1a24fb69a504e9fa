// The map in use, cell by cell: whole maps unpacked, changes laid in, gaps waited out.

/** @typedef {{ rows: number, cols: number, resolution_m: number, origin_x_m: number, origin_y_m: number, map_id: string }} Placement */

export const SIDE = 512;
/** Larger maps than the daemon makes are not unpacked: who sends one is mistaken, or no friend. */
const MOST_CELLS = 2 ** 26;

export class Grid {
  /** @type {Placement | null} */
  placement = null;
  /** @type {Uint8Array} row 0 is the lowest y */
  cells = new Uint8Array(0);
  generation = -1;
  /** Counts the changes that were laid in. */
  version = 0;
  /** At which version a cell of each tile changed last; of a map that came whole, all of them. @type {Map<number, number>} */
  changedAt = new Map();
  #wholeAt = 0;
  #turn = Promise.resolve();

  /** Take a `map_changed`, after those before it: unpacking takes a while. @param {any} fields */
  accept(fields) {
    this.#turn = this.#turn.then(() => this.#lay(fields)).catch((error) => console.warn('a map was left out', error));
    return this.#turn;
  }

  forget() {
    this.#turn = this.#turn.then(() => this.#clear());
  }

  /** At which version a cell of a tile changed last. @param {number} tile */
  tileVersion(tile) {
    return this.changedAt.get(tile) ?? this.#wholeAt;
  }

  /** The value of the cell at a place of the map; null where there is none. @param {number} x @param {number} y */
  valueAt(x, y) {
    const place = this.placement;
    if (place === null) return null;
    const col = Math.floor((x - place.origin_x_m) / place.resolution_m);
    const row = Math.floor((y - place.origin_y_m) / place.resolution_m);
    return col < 0 || row < 0 || col >= place.cols || row >= place.rows ? null : (this.cells[row * place.cols + col] ?? null);
  }

  #clear() {
    this.placement = null;
    this.cells = new Uint8Array(0);
    this.generation = -1;
    this.#wholeAt = ++this.version;
    this.changedAt.clear();
  }

  /** @param {any} fields */
  async #lay(fields) {
    if (fields.map_id === null) return this.#clear();
    if (fields.whole) return this.#layWhole(fields);
    // What does not follow on what is known waits for the whole map, which the gateway asks for.
    if (!isPlacedAs(this.placement, fields) || fields.generation !== this.generation + 1) return;
    this.version++;
    const indices = words(fields.indices_u32le);
    indices.forEach((index, n) => {
      if (index >= this.cells.length) return;
      this.cells[index] = fields.values_u8[n];
      this.#touch(index);
    });
    this.generation = fields.generation;
  }

  /** @param {any} fields */
  async #layWhole(fields) {
    const { rows, cols } = fields;
    if (!(rows > 0 && cols > 0 && rows * cols <= MOST_CELLS)) throw new RangeError(`${rows} x ${cols} cells`);
    const cells = await unpacked(fields.cells_zlib, rows * cols);
    const isSame = isPlacedAs(this.placement, fields);
    const before = this.cells;
    this.cells = cells;
    this.placement = {
      rows, cols, resolution_m: fields.resolution_m, origin_x_m: fields.origin_x_m, origin_y_m: fields.origin_y_m, map_id: fields.map_id,
    };
    this.generation = fields.generation;
    this.version++;
    if (!isSame) {
      this.#wholeAt = this.version;
      this.changedAt.clear();
    } else for (let index = 0; index < cells.length; index++) if (cells[index] !== before[index]) this.#touch(index);
  }

  /** @param {number} index */
  #touch(index) {
    const cols = this.placement?.cols ?? 1;
    const across = Math.ceil(cols / SIDE);
    this.changedAt.set(Math.floor(Math.floor(index / cols) / SIDE) * across + Math.floor((index % cols) / SIDE), this.version);
  }
}

/** @param {Placement | null} place @param {any} fields */
function isPlacedAs(place, fields) {
  return place !== null && /** @type {const} */ (['rows', 'cols', 'resolution_m', 'origin_x_m', 'origin_y_m', 'map_id']).every((name) => place[name] === fields[name]);
}

/** @param {Uint8Array} bytes little-endian */
export function words(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  return Array.from({ length: bytes.byteLength / 4 }, (_, n) => view.getUint32(4 * n, true));
}

/**
 * Return what zlib packed; no more of it than was promised.
 * @param {Uint8Array} packed @param {number} length
 */
export async function unpacked(packed, length) {
  const stream = new Blob([packed.slice()]).stream().pipeThrough(new DecompressionStream('deflate'));
  const found = new Uint8Array(length);
  let filled = 0;
  const reader = stream.getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    if (filled + value.length > length) {
      await reader.cancel();
      throw new RangeError(`more than the ${length} cells that were promised`);
    }
    found.set(value, filled);
    filled += value.length;
  }
  if (filled !== length) throw new RangeError(`${filled} of ${length} cells`);
  return found;
}
