// An act that is being prepared: what was picked on the map so far, and how that is drawn.
import { drawStop } from '../../map/layers.js';

/** @typedef {import('../../app.js').App} App */
/** @typedef {{ x: number, y: number }} Place */

export class Draft {
  /** @type {'go' | 'here' | 'map' | 'explore' | null} */
  act = null;
  /** @type {Place | null} */
  goal = null;
  /** The way there, or why there is none; null while it is sought, undefined where the daemon cannot tell. @type {any} */
  way = null;
  /** @type {{ x: number, y: number, radius: number } | null} */
  disk = null;
  /** @type {Place[]} */
  stops = [];
  name = '';
  /** Where a new map begins, if that was said otherwise. @type {{ x_m: number, y_m: number, heading_rad: number } | null} */
  start = null;
  unattended = false;

  /** @param {App} app */
  constructor(app) {
    this.app = app;
  }

  /** Begin to prepare an act. @param {'go' | 'here' | 'map' | 'explore'} act */
  begin(act) {
    this.cancel();
    this.act = act;
    this.listen();
    this.app.wake(true);
  }

  /** Take places from the canvas that is there now: it is another one after another page was open. */
  listen() {
    const { act, app: { canvas } } = this;
    if (canvas === null) return;
    if (act === 'go') canvas.onPick = (place) => this.aim(place);
    if (act === 'map') canvas.onPick = (place) => { this.stops = [...this.stops, place]; this.app.wake(true); };
    if (act === 'here') {
      canvas.onPick = (place) => this.circle(place, 1);
      canvas.onDrag = (from, to) => this.circle(from, Math.max(0.2, Math.hypot(to.x - from.x, to.y - from.y)));
    }
  }

  cancel() {
    const { canvas } = this.app;
    if (canvas !== null) canvas.onPick = canvas.onDrag = null;
    Object.assign(this, { act: null, goal: null, way: null, disk: null, stops: [], start: null });
    this.app.wake(true);
  }

  /** Take a goal, and ask for the way there. @param {Place} place */
  async aim(place) {
    this.goal = place;
    this.way = null;
    this.app.wake(true);
    try {
      const way = await this.app.link.ask('command', { cmd: 'plan_to', args: { x_m: place.x, y_m: place.y } });
      if (this.goal === place) this.way = way;
    } catch {
      if (this.goal === place) this.way = undefined;
    }
    this.app.wake(true);
  }

  /** @param {Place} place @param {number} radius */
  circle({ x, y }, radius) {
    this.disk = { x, y, radius };
    this.app.wake(true);
  }

  /** @param {import('../../map/layers.js').Pen} pen */
  paint(pen) {
    const { context, px, colour } = pen;
    context.strokeStyle = context.fillStyle = colour('draft');
    context.lineWidth = 2.5 * px;
    if (this.goal !== null) {
      const best = this.app.state.pose?.best;
      if (best && this.way?.waypoints_m?.length > 0) {
        context.beginPath();
        context.moveTo(best.x_m, best.y_m);
        for (const [x, y] of this.way.waypoints_m) context.lineTo(x, y);
        context.stroke();
      }
      cross(pen, this.goal.x, this.goal.y);
    }
    if (this.disk !== null) {
      context.beginPath();
      context.arc(this.disk.x, this.disk.y, this.disk.radius, 0, 2 * Math.PI);
      context.globalAlpha = 0.2;
      context.fill();
      context.globalAlpha = 1;
      context.stroke();
    }
    this.stops.forEach(({ x, y }, index) => drawStop(pen, x, y, 'waiting', String(index + 1)));
  }
}

/** @param {import('../../map/layers.js').Pen} pen @param {number} x @param {number} y */
function cross({ context, px }, x, y) {
  const side = 11 * px;
  context.beginPath();
  context.moveTo(x - side, y); context.lineTo(x + side, y);
  context.moveTo(x, y - side); context.lineTo(x, y + side);
  context.stroke();
  context.beginPath();
  context.arc(x, y, 0.65 * side, 0, 2 * Math.PI);
  context.stroke();
}

/** @type {Draft | null} */
let draft = null;

/** The one that is being prepared on this page. @param {App} app */
export function draftOf(app) {
  draft ??= new Draft(app);
  return draft;
}
