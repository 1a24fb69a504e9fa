// Moving the map by pointer, wheel, fingers and keys, and picking places on it.
import { panned, toMap, zoomed } from './view.js';

/** @typedef {import('./canvas.js').Place} Place */

const STEP_PX = 60;
const CLICK_PX = 6;

export class Hands {
  /** @type {Map<number, { x: number, y: number }>} */
  #fingers = new Map();
  #moved = 0;
  /** @type {Place | null} */
  #from = null;

  /** @param {HTMLElement} frame @param {import('./canvas.js').MapCanvas} map */
  constructor(frame, map) {
    this.frame = frame;
    this.map = map;
    frame.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    frame.addEventListener('pointerdown', (event) => this.#down(event));
    frame.addEventListener('pointermove', (event) => this.#move(event));
    frame.addEventListener('pointerup', (event) => this.#up(event));
    frame.addEventListener('pointercancel', (event) => this.#fingers.delete(event.pointerId));
    // A finger that is lifted leaves, too, and what it tapped is still to be read.
    frame.addEventListener('pointerleave', (event) => event.pointerType === 'mouse' && map.onPoint(null));
    frame.addEventListener('keydown', (event) => this.#key(event));
  }

  /** @param {MouseEvent} event */
  #at(event) {
    const box = this.frame.getBoundingClientRect();
    return { px: event.clientX - box.left, py: event.clientY - box.top };
  }

  /** @param {number} px @param {number} py */
  #place(px, py) {
    return toMap(this.map.view, this.map.size, px, py);
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    event.preventDefault();
    const { px, py } = this.#at(event);
    this.map.look(zoomed(this.map.view, this.map.size, Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0015)), px, py));
  }

  /** @param {PointerEvent} event */
  #down(event) {
    this.frame.setPointerCapture(event.pointerId);
    this.#fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.#moved = this.#fingers.size > 1 ? Infinity : 0;
    const { px, py } = this.#at(event);
    this.#from = this.map.onDrag === null ? null : this.#place(px, py);
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const { px, py } = this.#at(event);
    this.map.onPoint(this.#place(px, py));
    const before = this.#fingers.get(event.pointerId);
    if (before === undefined) return;
    const dx = event.clientX - before.x, dy = event.clientY - before.y;
    this.#moved += Math.hypot(dx, dy);
    const other = [...this.#fingers].find(([id]) => id !== event.pointerId)?.[1];
    this.#fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (other !== undefined) {
      const apart = Math.hypot(before.x - other.x, before.y - other.y) || 1;
      const factor = Math.hypot(event.clientX - other.x, event.clientY - other.y) / apart;
      const box = this.frame.getBoundingClientRect();
      this.#lead(panned(zoomed(this.map.view, this.map.size, factor, other.x - box.left, other.y - box.top), dx / 2, dy / 2));
    } else if (this.#from !== null && this.map.onDrag !== null) {
      this.map.onDrag(this.#from, this.#place(px, py), false);
    } else if (this.#moved > CLICK_PX) {
      this.#lead(panned(this.map.view, dx, dy));
    }
  }

  /** @param {PointerEvent} event */
  #up(event) {
    this.#fingers.delete(event.pointerId);
    const { px, py } = this.#at(event);
    const place = this.#place(px, py);
    this.map.onPoint(place);
    if (this.#from !== null && this.map.onDrag !== null) this.map.onDrag(this.#from, place, true);
    else if (this.#moved <= CLICK_PX) this.map.onPick?.(place);
    this.#from = null;
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const { map } = this;
    const { width, height } = map.size;
    const acts = /** @type {Record<string, () => void>} */ ({
      ArrowLeft: () => this.#lead(panned(map.view, STEP_PX, 0)),
      ArrowRight: () => this.#lead(panned(map.view, -STEP_PX, 0)),
      ArrowUp: () => this.#lead(panned(map.view, 0, STEP_PX)),
      ArrowDown: () => this.#lead(panned(map.view, 0, -STEP_PX)),
      '+': () => map.look(zoomed(map.view, map.size, 1.25, width / 2, height / 2)),
      '=': () => map.look(zoomed(map.view, map.size, 1.25, width / 2, height / 2)),
      '-': () => map.look(zoomed(map.view, map.size, 0.8, width / 2, height / 2)),
      '0': () => map.fit(),
      Enter: () => map.onPick?.(map.middle),
    });
    const act = acts[event.key];
    if (act === undefined) return;
    event.preventDefault();
    act();
    map.onPoint(map.middle);
  }

  /** Look elsewhere than where the robot is: who moves the map follows it no longer. @param {import('./view.js').View} view */
  #lead(view) {
    this.map.follows = false;
    this.map.look(view);
  }
}
