// What lies below everything that moves, as one picture: cells, what lies over them, and lines. It is painted again when
// one of these, the place or the scale is another; a robot that drives, or a map that is moved a little, paints nothing.
import { drawLines } from './layers.js';
import { Clearance, drawOverlay } from './overlays.js';
import { colours } from './paint.js';
import { Tiles } from './tiles.js';

/**
 * What a sheet shows: pixels, metres, and how many pixels of the screen each of the page has.
 * @typedef {import('./view.js').View & { width: number, height: number, ratio: number, step: number, box: { x0: number, y0: number, x1: number, y1: number } }} Sheet
 */
/** @typedef {import('./overlays.js').Overlay} Overlay */

export class Ground {
  #picture = new OffscreenCanvas(1, 1);
  #clearance = new Clearance();
  #colours = /** @type {Record<string, string>} */ ({});
  /** What was painted last. @type {unknown[]} */
  #painted = [];
  #isUnfinished = false;

  /** @param {import('./grid.js').Grid} grid */
  constructor(grid) {
    this.grid = grid;
    this.tiles = new Tiles(grid);
  }

  /** @param {import('./paint.js').Palette} palette @param {Record<string, string>} names */
  recolour(palette, names) {
    this.#colours = names;
    this.tiles.recolour(colours(palette));
    this.#painted = [];
  }

  /**
   * Return the ground of a sheet, and whether there is more of it to come.
   * @param {Sheet} sheet @param {Overlay | null} rank @param {number} clearance radius [m] of what has to fit; 0 shows nothing of it
   */
  picture(sheet, rank, clearance) {
    const narrow = clearance > 0 ? this.#clearance.look(this.grid, clearance, performance.now()) : null;
    const { x, y, scale, width, height, ratio } = sheet;
    const wanted = [x, y, scale, width, height, ratio, rank, narrow, this.grid.placement, this.grid.version];
    if (this.#isUnfinished || wanted.some((one, index) => one !== this.#painted[index])) {
      this.#painted = wanted;
      this.#paint(sheet, [rank, narrow]);
    }
    return { picture: this.#picture, isUnfinished: this.#isUnfinished };
  }

  /** @param {Sheet} sheet @param {(Overlay | null)[]} overlays */
  #paint({ x, y, scale, width, height, ratio, box, step }, overlays) {
    const [across, up] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.#picture.width !== across || this.#picture.height !== up) this.#picture = new OffscreenCanvas(across, up);
    const context = this.#picture.getContext('2d', { alpha: false });
    if (context === null) return;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.#colours['unknown'] ?? '#000';
    context.fillRect(0, 0, across, up);
    context.setTransform(scale * ratio, 0, 0, -scale * ratio, (width / 2 - x * scale) * ratio, (height / 2 + y * scale) * ratio);
    this.#isUnfinished = this.tiles.draw(context, box);
    for (const overlay of overlays) if (overlay !== null) drawOverlay(context, overlay);
    drawLines({ context, px: 1 / scale, colour: (name) => this.#colours[name] ?? '#f0f' }, box, step);
  }
}
