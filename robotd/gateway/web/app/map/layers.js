// What is drawn on the map, one function a layer; the context's unit is the metre, y up, and `px` is a pixel in metres.

/** @typedef {import('../types').State} State */
/** @typedef {{ context: CanvasRenderingContext2D, px: number, colour: (name: string) => string, robotRadius: number }} Pen */

const TURN = 2 * Math.PI;

/** The layers that can be switched, in the order in which they are drawn, with their keys. */
export const LAYERS = /** @type {const} */ ([
  { name: 'rank', key: '1' }, { name: 'clearance', key: '6' }, { name: 'way', key: '4' }, { name: 'plan', key: '5' },
  { name: 'sweep', key: '3' }, { name: 'belief', key: '2' },
]);

/** @param {Pen} pen @param {[number, number][]} points */
export function drawWay({ context, px, colour }, points) {
  if (points.length < 2) return;
  context.beginPath();
  points.forEach(([x, y], index) => (index === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  context.strokeStyle = colour('way');
  context.lineWidth = 2 * px;
  context.stroke();
}

/** @param {Pen} pen @param {import('../types').Plan} plan */
export function drawPlan(pen, plan) {
  const { context, px, colour } = pen;
  if (plan.start_m !== null && plan.waypoints_m.length > 0) {
    context.beginPath();
    context.moveTo(...plan.start_m);
    for (const [x, y] of plan.waypoints_m) context.lineTo(x, y);
    context.setLineDash([6 * px, 4 * px]);
    context.strokeStyle = colour('plan');
    context.lineWidth = 2.5 * px;
    context.stroke();
    context.setLineDash([]);
  }
  plan.stops.forEach((stop, index) => drawStop(pen, stop.x_m, stop.y_m, stop.state, String(index + 1)));
}

/** @param {Pen} pen @param {number} x @param {number} y @param {string} state @param {string} label */
export function drawStop({ context, px, colour }, x, y, state, label) {
  const side = 9 * px;
  context.beginPath();
  if (state === 'unreached') {
    context.moveTo(x - side, y - side); context.lineTo(x + side, y + side);
    context.moveTo(x - side, y + side); context.lineTo(x + side, y - side);
  } else context.arc(x, y, side, 0, TURN);
  context.lineWidth = 2 * px;
  context.strokeStyle = colour(state === 'unreached' ? 'against' : 'plan');
  context.fillStyle = state === 'swept' ? colour('plan') : colour('paper');
  if (state !== 'unreached') context.fill();
  context.stroke();
  write({ context, px }, label, x, y, state === 'swept' ? colour('paper') : colour('ink'));
}

/** @param {{ context: CanvasRenderingContext2D, px: number }} pen @param {string} text @param {number} x @param {number} y @param {string} style */
function write({ context, px }, text, x, y, style) {
  context.save();
  context.translate(x, y);
  context.scale(px, -px);
  context.font = '600 11px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillStyle = style;
  context.fillText(text, 0, 0);
  context.restore();
}

/** @param {Pen} pen @param {import('../types').Sweep} sweep @param {import('../types').Estimate | null} estimate */
export function drawSweep({ context, px, colour }, sweep, estimate) {
  const at = sweep.in_map;
  if (at === null) return;
  const explained = explainedBy(estimate);
  const [cos, sin] = [Math.cos(at.heading_rad), Math.sin(at.heading_rad)];
  for (const reading of sweep.readings) {
    if (reading.range_m === null) continue;
    const fromX = at.x_m + cos * reading.origin_x_m - sin * reading.origin_y_m;
    const fromY = at.y_m + sin * reading.origin_x_m + cos * reading.origin_y_m;
    const angle = at.heading_rad + reading.bearing_rad;
    const x = fromX + reading.range_m * Math.cos(angle), y = fromY + reading.range_m * Math.sin(angle);
    if (reading.status === 'miss') {
      // Nothing met: only how far it looked, as a short stroke.
      context.beginPath();
      context.moveTo(x - 6 * px * Math.cos(angle), y - 6 * px * Math.sin(angle));
      context.lineTo(x, y);
      context.lineWidth = px;
      context.strokeStyle = colour('quiet');
      context.stroke();
      continue;
    }
    const is = explained.get(key(reading.bearing_rad));
    context.fillStyle = colour(is === false ? 'against' : 'reading');
    if (is === false) mark(context, x, y, 3.2 * px);
    else {
      context.beginPath();
      context.arc(x, y, 2.2 * px, 0, TURN);
      context.fill();
    }
  }
}

/** A square on its corner: told from a dot without its colour. @param {CanvasRenderingContext2D} context @param {number} x @param {number} y @param {number} side */
function mark(context, x, y, side) {
  context.beginPath();
  context.moveTo(x - side, y); context.lineTo(x, y - side); context.lineTo(x + side, y); context.lineTo(x, y + side);
  context.closePath();
  context.fill();
}

/** @param {number} bearing */
const key = (bearing) => Math.round(bearing * 1e4);

/** @param {import('../types').Estimate | null} estimate */
function explainedBy(estimate) {
  const region = estimate?.regions[0];
  if (!estimate || region === undefined) return new Map();
  return new Map(estimate.bearings_rad.map((bearing, index) => [key(bearing), region.explained[index]]));
}

/** @param {Pen} pen @param {import('../types').Estimate} estimate @param {import('./grid.js').Placement} place */
export function drawBelief({ context, px, colour }, estimate, place) {
  estimate.regions.forEach((region, index) => {
    const side = place.resolution_m, block = region.cover.block_cells;
    context.fillStyle = colour('region');
    context.globalAlpha = 0.18 + 0.4 * Math.min(1, region.belief);
    for (const [row, first, last] of region.cover.runs) {
      context.fillRect(place.origin_x_m + first * block * side, place.origin_y_m + row * block * side, (last - first + 1) * block * side, block * side);
    }
    context.globalAlpha = 1;
    const { x_min_m: x0, x_max_m: x1, y_min_m: y0, y_max_m: y1, heading_min_rad: h0, heading_max_rad: h1 } = region.extent;
    context.strokeStyle = colour('region');
    context.lineWidth = 1.5 * px;
    context.strokeRect(x0 - 2 * px, y0 - 2 * px, x1 - x0 + 4 * px, y1 - y0 + 4 * px);
    // The fan of headings, from its middle.
    const { x_m: x, y_m: y } = region.pose, reach = Math.max(26 * px, 0.4);
    context.beginPath();
    context.moveTo(x, y);
    context.arc(x, y, reach, h0, h1);
    context.closePath();
    context.globalAlpha = 0.3;
    context.fill();
    context.globalAlpha = 1;
    context.stroke();
    if (estimate.regions.length > 1) write({ context, px }, String(index + 1), x, y - 16 * px, colour('ink'));
  });
}

/** @param {Pen} pen @param {import('../types').Pose} pose @param {'sure' | 'carried' | 'stale'} how */
export function drawRobot({ context, px, colour, robotRadius }, pose, how) {
  const radius = Math.max(robotRadius, 5 * px);
  context.save();
  context.translate(pose.x_m, pose.y_m);
  context.rotate(pose.heading_rad);
  context.beginPath();
  context.arc(0, 0, radius, 0, TURN);
  context.fillStyle = colour(how === 'stale' ? 'quiet' : 'robot');
  context.globalAlpha = how === 'sure' ? 0.9 : 0.45;
  context.fill();
  context.globalAlpha = 1;
  context.lineWidth = 2 * px;
  if (how === 'carried') context.setLineDash([5 * px, 3 * px]);
  context.strokeStyle = colour(how === 'stale' ? 'ink' : 'robot_edge');
  context.stroke();
  context.setLineDash([]);
  context.beginPath();
  context.moveTo(0.15 * radius, 0);
  context.lineTo(1.35 * radius, 0);
  context.lineWidth = 3 * px;
  context.stroke();
  context.restore();
}

/** @param {Pen} pen @param {{ x0: number, y0: number, x1: number, y1: number }} box seen */
export function drawGrid({ context, px, colour }, box) {
  const step = niceStep(80 * px);
  context.strokeStyle = colour('grid');
  context.lineWidth = px;
  context.beginPath();
  for (let x = Math.ceil(box.x0 / step) * step; x <= box.x1; x += step) { context.moveTo(x, box.y0); context.lineTo(x, box.y1); }
  for (let y = Math.ceil(box.y0 / step) * step; y <= box.y1; y += step) { context.moveTo(box.x0, y); context.lineTo(box.x1, y); }
  context.stroke();
  return step;
}

/** Return the least of 1, 2, 5 times a power of ten that is no less. @param {number} least */
export function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= least) ?? 10 * power;
}
