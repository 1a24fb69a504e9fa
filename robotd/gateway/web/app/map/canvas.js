// The map on the screen: a sheet larger than what is seen of it, drawn when something on it changed. To move the map is
// to move the sheet, which draws nothing, until its edge comes near.
import { silent } from '../state/silence.js';
import { Ground } from './ground.js';
import { Hands } from './hands.js';
import * as layers from './layers.js';
import { fitted, seen, toPixel } from './view.js';

/** @typedef {import('./layers.js').Pen} Pen */
/** @typedef {{ x: number, y: number }} Place */
/** @typedef {import('./view.js').View} View */

/** How far the sheet reaches beyond each side of what is seen. */
const ROOM_PX = 256;
const LINE_PX = 80;
const COLOURS = ['paper', 'ink', 'quiet', 'grid', 'robot', 'robot_edge', 'way', 'plan', 'reading', 'against', 'region', 'draft', 'free', 'wall', 'unknown'];

export class MapCanvas {
  /** @type {View} */
  view = { x: 0, y: 0, scale: 60 };
  follows = false;
  /** The heat map, while there is one. @type {import('./overlays.js').Overlay | null} */
  rank = null;
  /** Is told which layers are shown. @type {() => void} */
  onLayers = () => {};
  shown = new Set(['belief', 'sweep', 'way', 'plan']);
  robotRadius = 0.3;
  /** What is drawn of an act that is being prepared. @type {((pen: Pen) => void) | null} */
  draft = null;
  /** Takes places that are clicked, while an act needs them. @type {((place: Place) => void) | null} */
  onPick = null;
  /** Takes a drag from a place to another, while an act needs one. @type {((from: Place, to: Place, isOver: boolean) => void) | null} */
  onDrag = null;
  /** Is told where the pointer is. @type {(place: Place | null) => void} */
  onPoint = () => {};
  /** Is told how long a metre's step is on the screen. @type {(step: number, px: number) => void} */
  onScale = () => {};
  /** Of what is seen [px]. */
  size = { width: 0, height: 0 };
  /** How long each frame took, the last of them [ms]. @type {number[]} */
  times = [];
  #frame;
  #canvas;
  #ground;
  #isWanted = false;
  #isOld = true;
  #isFitted = false;
  #colours = /** @type {Record<string, string>} */ ({});
  /** What the sheet was drawn of: the place in its middle, and at which scale. @type {View | null} */
  #sheet = null;

  /** @param {HTMLElement} frame through which the map is seen @param {import('../types').State} state @param {import('./grid.js').Grid} grid */
  constructor(frame, state, grid) {
    this.#frame = frame;
    this.#canvas = frame.appendChild(document.createElement('canvas'));
    this.state = state;
    this.grid = grid;
    this.#ground = new Ground(grid);
    // Its first call comes when the frame is on the page: before that it has neither size nor colours.
    new ResizeObserver(() => this.#resized()).observe(frame);
    new Hands(frame, this);
  }

  /** Look as the map did that was on the page before. @param {MapCanvas} before */
  resume(before) {
    Object.assign(this, { view: before.view, shown: before.shown, rank: before.rank, follows: before.follows });
    this.#isFitted = before.#isFitted;
  }

  /** Take the colours of the theme. */
  recolour() {
    const style = getComputedStyle(this.#frame);
    this.#colours = Object.fromEntries(COLOURS.map((name) => [name, style.getPropertyValue(`--map-${name.replace('_', '-')}`).trim()]));
    const rgb = (/** @type {string} */ name) => channels(this.#colours[name] ?? '');
    this.#ground.recolour({ free: rgb('free'), wall: rgb('wall'), unknown: rgb('unknown') }, this.#colours);
    this.wake();
  }

  /** Draw soon: something on the sheet is another. */
  wake() {
    this.#isOld = true;
    this.#soon();
  }

  /** Look elsewhere. @param {View} view */
  look(view) {
    this.view = view;
    this.#soon();
  }

  /** Show all of the map that somebody saw. */
  fit() {
    const place = this.grid.placement;
    this.follows = false;
    this.look(place === null ? this.view : fitted(seen(place, this.grid.cells), this.size));
  }

  follow() {
    this.follows = !this.follows;
    this.#soon();
    return this.follows;
  }

  /** @param {string} layer */
  toggle(layer) {
    if (!this.shown.delete(layer)) this.shown.add(layer);
    this.onLayers();
    this.wake();
  }

  /** Whether all is drawn that there is to draw now. */
  get isDrawn() {
    return this.#sheet !== null && !this.#isOld && !this.#isWanted;
  }

  /** The place in the middle of what is seen: where keys pick. */
  get middle() {
    return { x: this.view.x, y: this.view.y };
  }

  /** Where a place of the map is on the screen. @param {Place} place */
  pixel({ x, y }) {
    return toPixel(this.view, this.size, x, y);
  }

  #resized() {
    this.size = { width: this.#frame.clientWidth, height: this.#frame.clientHeight };
    this.#sheet = null;
    this.recolour();
  }

  #soon() {
    if (this.#isWanted) return;
    this.#isWanted = true;
    requestAnimationFrame(() => {
      this.#isWanted = false;
      const begun = performance.now();
      if (this.size.width > 0) this.#show();
      this.times.push(performance.now() - begun);
      if (this.times.length > 240) this.times.shift();
    });
  }

  #show() {
    if (!this.#isFitted && this.grid.placement !== null) {
      this.#isFitted = true;
      this.fit();
    }
    const best = this.state.pose?.best ?? null;
    if (this.follows && best !== null) this.view = { ...this.view, x: best.x_m, y: best.y_m };
    this.#frame.classList.toggle('picks', this.onPick !== null);
    if (this.#sheet === null || !isWithin(this.#sheet, this.view)) {
      this.#sheet = ahead(this.#sheet, this.view);
      this.#isOld = true;
    }
    if (this.#isOld) this.#draw(this.#sheet);
    const { dx, dy } = apart(this.#sheet, this.view);
    const whole = (/** @type {number} */ px) => Math.round(px * devicePixelRatio) / devicePixelRatio;
    this.#canvas.style.transform = `translate(${whole(dx)}px, ${whole(dy)}px)`;
  }

  /** @param {View} sheet */
  #draw(sheet) {
    this.#isOld = false;
    const ratio = devicePixelRatio;
    const width = this.size.width + 2 * ROOM_PX, height = this.size.height + 2 * ROOM_PX;
    const context = this.#canvas.getContext('2d', { alpha: false });
    if (context === null) return;
    if (this.#canvas.width !== Math.round(width * ratio)) this.#canvas.width = Math.round(width * ratio);
    if (this.#canvas.height !== Math.round(height * ratio)) this.#canvas.height = Math.round(height * ratio);
    const step = layers.niceStep(LINE_PX / sheet.scale);
    this.onScale(step, step * sheet.scale);
    const box = { x0: sheet.x - width / 2 / sheet.scale, y0: sheet.y - height / 2 / sheet.scale, x1: sheet.x + width / 2 / sheet.scale, y1: sheet.y + height / 2 / sheet.scale };
    const rank = this.shown.has('rank') ? this.rank : null;
    const ground = this.#ground.picture({ ...sheet, width, height, ratio, box, step }, rank, this.shown.has('clearance') ? this.robotRadius : 0);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(ground.picture, 0, 0);
    if (ground.isUnfinished) this.wake();
    context.setTransform(sheet.scale * ratio, 0, 0, -sheet.scale * ratio, (width / 2 - sheet.x * sheet.scale) * ratio, (height / 2 + sheet.y * sheet.scale) * ratio);
    /** @type {Pen} */
    const pen = { context, px: 1 / sheet.scale, colour: (name) => this.#colours[name] ?? '#f0f', robotRadius: this.robotRadius };
    this.#drawLayers(pen);
    this.draft?.(pen);
  }

  /** @param {Pen} pen */
  #drawLayers(pen) {
    const { state, grid } = this;
    const isStale = silent(state, performance.now()) !== null;
    const isOfThisMap = state.pose !== null && grid.placement !== null && state.pose.map_id === grid.placement.map_id;
    if (this.shown.has('way')) layers.drawWay(pen, state.way);
    if (this.shown.has('plan')) layers.drawIntentions(pen, state, grid.placement?.map_id ?? null);
    if (this.shown.has('sweep') && state.sweep !== null) layers.drawSweep(pen, state.sweep, state.pose);
    if (this.shown.has('belief') && state.pose !== null && grid.placement !== null && isOfThisMap) layers.drawBelief(pen, state.pose, grid.placement);
    if (state.pose?.best) layers.drawRobot(pen, state.pose.best, isStale ? 'stale' : state.pose.state === 'localized' ? 'sure' : 'carried');
  }
}

/** How far a sheet has to be moved to show a view [px]. @param {View} sheet @param {View} view */
function apart(sheet, view) {
  return { dx: (sheet.x - view.x) * view.scale, dy: (view.y - sheet.y) * view.scale };
}

/** @param {View} sheet @param {View} view */
function isWithin(sheet, view) {
  const { dx, dy } = apart(sheet, view);
  return sheet.scale === view.scale && Math.abs(dx) <= ROOM_PX && Math.abs(dy) <= ROOM_PX;
}

/** A sheet for a view that left one: with most of its room where the view goes, and so twice as long before the next. @param {View | null} sheet @param {View} view */
function ahead(sheet, view) {
  if (sheet === null || sheet.scale !== view.scale) return { ...view };
  const { dx, dy } = apart(sheet, view);
  const lead = (/** @type {number} */ px) => (Math.abs(px) > 2 * ROOM_PX ? 0 : (0.8 * px * ROOM_PX) / Math.max(Math.abs(dx), Math.abs(dy)) / view.scale);
  return { ...view, x: view.x - lead(dx), y: view.y + lead(dy) };
}

/** The channels of `#rrggbb`. @param {string} colour @returns {[number, number, number]} */
function channels(colour) {
  const number = Number.parseInt(colour.slice(1), 16) || 0;
  return [(number >> 16) & 255, (number >> 8) & 255, number & 255];
}
