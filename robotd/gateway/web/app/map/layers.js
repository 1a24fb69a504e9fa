// What is drawn on the map, one function a layer; the context's unit is the metre, y up, and `px` is a pixel in metres.

/** @typedef {import('../types').State} State */
/** @typedef {CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D} Context */
/** @typedef {{ context: Context, px: number, colour: (name: string) => string, robotRadius: number }} Pen */

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

/**
 * What the mission under way intends: its way and stops; of one that explores, where else it could go, and what is left open.
 * @param {Pen} pen @param {State} state @param {string | null} map in use
 */
export function drawIntentions(pen, state, map) {
  const { choice, exploringEnded: ended, plan, status } = state;
  if (status?.mission_id != null && choice !== null && choice.map_id === map) drawChoice(pen, choice);
  if (ended !== null && ended.map_id === map) for (const { x_m, y_m } of ended.left) drawOpening(pen, x_m, y_m);
  if (plan !== null && plan.mission_id === status?.mission_id) drawPlan(pen, plan);
}

/** Each place that a stop could have been at: the larger its ring, the more a look from there was expected to be worth. @param {Pen} pen @param {import('../types').Choice} choice */
function drawChoice({ context, px, colour }, choice) {
  const best = Math.max(...choice.candidates.map(({ score }) => score), 1e-9);
  context.strokeStyle = colour('quiet');
  context.lineWidth = 1.5 * px;
  for (const { x_m, y_m, score } of choice.candidates) {
    context.beginPath();
    context.arc(x_m, y_m, (3 + (7 * score) / best) * px, 0, TURN);
    context.stroke();
  }
  if (choice.tour_m.length < 2) return;
  context.beginPath();
  choice.tour_m.forEach(([x, y], index) => (index === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  context.setLineDash([2 * px, 5 * px]);
  context.stroke();
  context.setLineDash([]);
}

/** @param {Pen} pen @param {number} x @param {number} y */
function drawOpening({ context, px, colour }, x, y) {
  context.strokeStyle = colour('against');
  context.lineWidth = 2 * px;
  context.strokeRect(x - 5 * px, y - 5 * px, 10 * px, 10 * px);
}

/** @param {Pen} pen @param {import('../types').Plan} plan */
function drawPlan(pen, plan) {
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

/** @param {{ context: Context, px: number }} pen @param {string} text @param {number} x @param {number} y @param {string} style */
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

/**
 * A sweep, each kind of reading by a shape of its own: explained (a dot), unexplained (a square on its corner), missed (a
 * short stroke: nothing was met so far), rejected (a cross beside the robot: it failed, and says nothing of the room).
 * @param {Pen} pen @param {import('../types').Sweep} sweep @param {import('../types').Estimate | null} estimate
 */
export function drawSweep(pen, sweep, estimate) {
  const { context, px, colour, robotRadius } = pen;
  const at = sweep.in_map;
  if (at === null) return;
  const explained = explainedBy(estimate);
  const [cos, sin] = [Math.cos(at.heading_rad), Math.sin(at.heading_rad)];
  const [dots, squares, strokes, crosses] = [new Path2D(), new Path2D(), new Path2D(), new Path2D()];
  const beside = Math.max(robotRadius, 5 * px) + 9 * px;
  for (const reading of sweep.readings) {
    const angle = at.heading_rad + reading.bearing_rad, [c, s] = [Math.cos(angle), Math.sin(angle)];
    if (reading.range_m === null) {
      addCross(crosses, at.x_m + beside * c, at.y_m + beside * s, 2.5 * px);
      continue;
    }
    const x = at.x_m + cos * reading.origin_x_m - sin * reading.origin_y_m + reading.range_m * c;
    const y = at.y_m + sin * reading.origin_x_m + cos * reading.origin_y_m + reading.range_m * s;
    if (reading.status === 'miss') {
      strokes.moveTo(x - 6 * px * c, y - 6 * px * s);
      strokes.lineTo(x, y);
    } else if (explained.get(key(reading.bearing_rad)) === false) addSquare(squares, x, y, 3.2 * px);
    else {
      dots.moveTo(x + 2.2 * px, y);
      dots.arc(x, y, 2.2 * px, 0, TURN);
    }
  }
  context.fillStyle = colour('reading');
  context.fill(dots);
  context.fillStyle = colour('against');
  context.fill(squares);
  context.strokeStyle = colour('quiet');
  context.lineWidth = px;
  context.stroke(strokes);
  context.stroke(crosses);
}

/** @param {Path2D} path @param {number} x @param {number} y @param {number} side */
function addCross(path, x, y, side) {
  path.moveTo(x - side, y - side); path.lineTo(x + side, y + side);
  path.moveTo(x - side, y + side); path.lineTo(x + side, y - side);
}

/** @param {Path2D} path @param {number} x @param {number} y @param {number} side */
function addSquare(path, x, y, side) {
  path.moveTo(x - side, y); path.lineTo(x, y - side); path.lineTo(x + side, y); path.lineTo(x, y + side);
  path.closePath();
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

/** @param {Omit<Pen, 'robotRadius'>} pen @param {{ x0: number, y0: number, x1: number, y1: number }} box @param {number} step from a line to the next */
export function drawLines({ context, px, colour }, box, step) {
  context.strokeStyle = colour('grid');
  context.lineWidth = px;
  context.beginPath();
  for (let x = Math.ceil(box.x0 / step) * step; x <= box.x1; x += step) { context.moveTo(x, box.y0); context.lineTo(x, box.y1); }
  for (let y = Math.ceil(box.y0 / step) * step; y <= box.y1; y += step) { context.moveTo(box.x0, y); context.lineTo(box.x1, y); }
  context.stroke();
}

/** Return the least of 1, 2, 5 times a power of ten that is no less. @param {number} least */
export function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= least) ?? 10 * power;
}
