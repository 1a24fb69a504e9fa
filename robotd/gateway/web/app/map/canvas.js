// The map on the screen: drawn when something changed, moved by hand, wheel, fingers and keys.
import { silent } from '../state/silence.js';
import * as layers from './layers.js';
import { Clearance, drawOverlay } from './overlays.js';
import { Tiles } from './tiles.js';
import { fitted, panned, seen, toMap, toPixel, zoomed } from './view.js';

/** @typedef {import('./layers.js').Pen} Pen */
/** @typedef {{ x: number, y: number }} Place */

const STEP_PX = 60;
const CLICK_PX = 6;
const COLOURS = ['paper', 'ink', 'quiet', 'grid', 'robot', 'robot_edge', 'way', 'plan', 'reading', 'against', 'region', 'draft', 'free', 'wall', 'unknown'];

export class MapCanvas {
  view = { x: 0, y: 0, scale: 60 };
  follows = false;
  /** The heat map, while there is one. @type {import('./overlays.js').Overlay | null} */
  rank = null;
  clearance = new Clearance();
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
  #canvas;
  #wanted = false;
  #isFitted = false;
  #colours = /** @type {Record<string, string>} */ ({});
  /** @type {Map<number, { x: number, y: number }>} */
  #fingers = new Map();
  #moved = 0;
  /** @type {Place | null} */
  #from = null;
  /** How long frames took to draw, the last of them [ms]. @type {number[]} */
  times = [];

  /** @param {HTMLCanvasElement} canvas @param {import('../types').State} state @param {import('./grid.js').Grid} grid */
  constructor(canvas, state, grid) {
    this.#canvas = canvas;
    this.state = state;
    this.grid = grid;
    this.tiles = new Tiles(grid);
    // Its first call comes when the canvas is on the page: before that it has no colours.
    new ResizeObserver(() => this.recolour()).observe(canvas);
    canvas.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener('pointerdown', (event) => this.#down(event));
    canvas.addEventListener('pointermove', (event) => this.#move(event));
    canvas.addEventListener('pointerup', (event) => this.#up(event));
    canvas.addEventListener('pointercancel', (event) => this.#fingers.delete(event.pointerId));
    canvas.addEventListener('pointerleave', () => this.onPoint(null));
    canvas.addEventListener('keydown', (event) => this.#key(event));
    canvas.addEventListener('blur', () => this.wake());
    canvas.addEventListener('focus', () => this.wake());
  }

  /** Take the colours of the theme. */
  recolour() {
    const style = getComputedStyle(this.#canvas);
    this.#colours = Object.fromEntries(COLOURS.map((name) => [name, style.getPropertyValue(`--map-${name.replace('_', '-')}`).trim()]));
    const rgb = (/** @type {string} */ name) => /** @type {[number, number, number]} */ (channels(this.#colours[name] ?? ''));
    this.tiles.recolour({ free: rgb('free'), wall: rgb('wall'), unknown: rgb('unknown') });
    this.wake();
  }

  /** Draw soon. */
  wake() {
    if (this.#wanted) return;
    this.#wanted = true;
    requestAnimationFrame(() => {
      this.#wanted = false;
      const begun = performance.now();
      this.#draw();
      this.times.push(performance.now() - begun);
      if (this.times.length > 240) this.times.shift();
    });
  }

  /** Show all of the map that somebody saw. */
  fit() {
    const place = this.grid.placement;
    if (place !== null) this.view = fitted(seen(place, this.grid.cells), this.size);
    this.follows = false;
    this.wake();
  }

  follow() {
    this.follows = !this.follows;
    this.wake();
    return this.follows;
  }

  /** @param {string} layer */
  toggle(layer) {
    if (!this.shown.delete(layer)) this.shown.add(layer);
    this.onLayers();
    this.wake();
  }

  get size() {
    return { width: this.#canvas.clientWidth, height: this.#canvas.clientHeight };
  }

  /** The place in the middle of what is seen: where keys pick. */
  get middle() {
    return { x: this.view.x, y: this.view.y };
  }

  #draw() {
    const { width, height } = this.size;
    const context = this.#canvas.getContext('2d');
    if (context === null || width === 0) return;
    const ratio = devicePixelRatio;
    if (this.#canvas.width !== Math.round(width * ratio)) this.#canvas.width = Math.round(width * ratio);
    if (this.#canvas.height !== Math.round(height * ratio)) this.#canvas.height = Math.round(height * ratio);
    if (!this.#isFitted && this.grid.placement !== null) {
      this.#isFitted = true;
      this.fit();
    }
    const best = this.state.pose?.best ?? null;
    if (this.follows && best !== null) this.view = { ...this.view, x: best.x_m, y: best.y_m };
    const { x, y, scale } = this.view;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.#colours['unknown'] ?? '#000';
    context.fillRect(0, 0, this.#canvas.width, this.#canvas.height);
    context.setTransform(scale * ratio, 0, 0, -scale * ratio, (width / 2 - x * scale) * ratio, (height / 2 + y * scale) * ratio);
    /** @type {Pen} */
    const pen = { context, px: 1 / scale, colour: (name) => this.#colours[name] ?? '#f0f', robotRadius: this.robotRadius };
    if (this.tiles.draw(context)) this.wake();
    const corner = toMap(this.view, this.size, 0, height), other = toMap(this.view, this.size, width, 0);
    if (this.shown.has('rank') && this.rank !== null) drawOverlay(context, this.rank);
    const narrow = this.shown.has('clearance') ? this.clearance.look(this.grid, this.robotRadius, performance.now()) : null;
    if (narrow !== null) drawOverlay(context, narrow);
    const step = layers.drawGrid(pen, { x0: corner.x, y0: corner.y, x1: other.x, y1: other.y });
    this.#drawLayers(pen);
    this.draft?.(pen);
    this.#drawScale(context, ratio, step);
  }

  /** @param {Pen} pen */
  #drawLayers(pen) {
    const { state, grid } = this;
    const isStale = silent(state, performance.now()) !== null;
    const isOfThisMap = state.pose !== null && grid.placement !== null && state.pose.map_id === grid.placement.map_id;
    if (this.shown.has('way')) layers.drawWay(pen, state.way);
    if (this.shown.has('plan') && state.plan !== null && state.plan.mission_id === state.status?.mission_id) layers.drawPlan(pen, state.plan);
    if (this.shown.has('sweep') && state.sweep !== null) layers.drawSweep(pen, state.sweep, state.pose);
    if (this.shown.has('belief') && state.pose !== null && grid.placement !== null && isOfThisMap) layers.drawBelief(pen, state.pose, grid.placement);
    if (state.pose?.best) layers.drawRobot(pen, state.pose.best, isStale ? 'stale' : state.pose.state === 'localized' ? 'sure' : 'carried');
  }

  /** @param {CanvasRenderingContext2D} context @param {number} ratio @param {number} step metres */
  #drawScale(context, ratio, step) {
    const { width, height } = this.size;
    const long = step * this.view.scale;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.strokeStyle = context.fillStyle = this.#colours['ink'] ?? '#fff';
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(16, height - 14); context.lineTo(16, height - 20); context.moveTo(16, height - 16);
    context.lineTo(16 + long, height - 16); context.lineTo(16 + long, height - 20);
    context.stroke();
    context.font = '12px system-ui, sans-serif';
    context.fillText(step >= 1 ? `${step} m` : `${Math.round(step * 100)} cm`, 22, height - 22);
    if (this.onPick !== null && document.activeElement === this.#canvas) {
      context.beginPath();
      context.moveTo(width / 2 - 14, height / 2); context.lineTo(width / 2 + 14, height / 2);
      context.moveTo(width / 2, height / 2 - 14); context.lineTo(width / 2, height / 2 + 14);
      context.stroke();
    }
  }

  /** @param {MouseEvent} event */
  #at(event) {
    const box = this.#canvas.getBoundingClientRect();
    return { px: event.clientX - box.left, py: event.clientY - box.top };
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    event.preventDefault();
    const { px, py } = this.#at(event);
    this.view = zoomed(this.view, this.size, Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0015)), px, py);
    this.follows = false;
    this.wake();
  }

  /** @param {PointerEvent} event */
  #down(event) {
    this.#canvas.setPointerCapture(event.pointerId);
    this.#fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.#moved = this.#fingers.size > 1 ? Infinity : 0;
    const { px, py } = this.#at(event);
    this.#from = this.onDrag === null ? null : toMap(this.view, this.size, px, py);
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const { px, py } = this.#at(event);
    this.onPoint(toMap(this.view, this.size, px, py));
    const before = this.#fingers.get(event.pointerId);
    if (before === undefined) return;
    const dx = event.clientX - before.x, dy = event.clientY - before.y;
    this.#moved += Math.hypot(dx, dy);
    const other = [...this.#fingers].find(([id]) => id !== event.pointerId)?.[1];
    this.#fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (other !== undefined) {
      const apart = Math.hypot(before.x - other.x, before.y - other.y) || 1;
      const factor = Math.hypot(event.clientX - other.x, event.clientY - other.y) / apart;
      const box = this.#canvas.getBoundingClientRect();
      this.view = panned(zoomed(this.view, this.size, factor, other.x - box.left, other.y - box.top), dx / 2, dy / 2);
    } else if (this.#from !== null && this.onDrag !== null) {
      this.onDrag(this.#from, toMap(this.view, this.size, px, py), false);
    } else if (this.#moved > CLICK_PX) {
      this.view = panned(this.view, dx, dy);
      this.follows = false;
    }
    this.wake();
  }

  /** @param {PointerEvent} event */
  #up(event) {
    this.#fingers.delete(event.pointerId);
    const { px, py } = this.#at(event);
    const place = toMap(this.view, this.size, px, py);
    if (this.#from !== null && this.onDrag !== null) this.onDrag(this.#from, place, true);
    else if (this.#moved <= CLICK_PX) this.onPick?.(place);
    this.#from = null;
    this.wake();
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const { width, height } = this.size;
    const acts = /** @type {Record<string, () => void>} */ ({
      ArrowLeft: () => (this.view = panned(this.view, STEP_PX, 0)),
      ArrowRight: () => (this.view = panned(this.view, -STEP_PX, 0)),
      ArrowUp: () => (this.view = panned(this.view, 0, STEP_PX)),
      ArrowDown: () => (this.view = panned(this.view, 0, -STEP_PX)),
      '+': () => (this.view = zoomed(this.view, this.size, 1.25, width / 2, height / 2)),
      '=': () => (this.view = zoomed(this.view, this.size, 1.25, width / 2, height / 2)),
      '-': () => (this.view = zoomed(this.view, this.size, 0.8, width / 2, height / 2)),
      '0': () => this.fit(),
      Enter: () => this.onPick?.(this.middle),
    });
    const act = acts[event.key];
    if (act === undefined) return;
    event.preventDefault();
    act();
    if (event.key.startsWith('Arrow')) this.follows = false;
    this.onPoint(this.middle);
    this.wake();
  }

  /** Where a place of the map is on the screen. @param {Place} place */
  pixel({ x, y }) {
    return toPixel(this.view, this.size, x, y);
  }
}

/** The channels of `#rrggbb`. @param {string} colour */
function channels(colour) {
  const number = Number.parseInt(colour.slice(1), 16) || 0;
  return [(number >> 16) & 255, (number >> 8) & 255, number & 255];
}
