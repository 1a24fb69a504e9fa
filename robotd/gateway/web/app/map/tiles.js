// The map as pictures of 512 x 512 cells, painted where a cell changed, a few at a time.
import { boundsOf, colours, paint } from './paint.js';

const AT_ONCE = 4;

export class Tiles {
  /** @type {Map<number, OffscreenCanvas>} */
  #pictures = new Map();
  /** @type {import('./grid.js').Placement | null} */
  #placement = null;
  #table = new Uint32Array(256);

  /** @param {import('./grid.js').Grid} grid */
  constructor(grid) {
    this.grid = grid;
  }

  /** Paint everything again in these colours. @param {import('./paint.js').Palette} palette */
  recolour(palette) {
    this.#table = colours(palette);
    this.#placement = null;
  }

  /** Draw the map; return whether there is more to paint. @param {CanvasRenderingContext2D} context whose unit is the metre */
  draw(context) {
    const place = this.grid.placement;
    if (place === null) return false;
    if (place !== this.#placement) {
      this.#pictures.clear();
      this.#placement = place;
      const count = Math.ceil(place.rows / 512) * Math.ceil(place.cols / 512);
      for (let tile = 0; tile < count; tile++) this.grid.dirty.add(tile);
    }
    const todo = [...this.grid.dirty].slice(0, AT_ONCE);
    for (const tile of todo) this.#paint(tile, place);
    context.imageSmoothingEnabled = false;
    for (const [tile, picture] of this.#pictures) {
      const { row, col, height, width } = boundsOf(tile, place);
      const side = place.resolution_m;
      context.save();
      context.translate(place.origin_x_m + col * side, place.origin_y_m + (row + height) * side);
      context.scale(side, -side);
      context.drawImage(picture, 0, 0, width, height);
      context.restore();
    }
    return this.grid.dirty.size > 0;
  }

  /** @param {number} tile @param {import('./grid.js').Placement} place */
  #paint(tile, place) {
    const bounds = boundsOf(tile, place);
    const picture = this.#pictures.get(tile) ?? new OffscreenCanvas(bounds.width, bounds.height);
    const context = picture.getContext('2d');
    if (context === null) return;
    const image = context.createImageData(bounds.width, bounds.height);
    paint(new Uint32Array(image.data.buffer), this.grid.cells, place.cols, bounds, this.#table);
    context.putImageData(image, 0, 0);
    this.#pictures.set(tile, picture);
    this.grid.dirty.delete(tile);
  }
}
