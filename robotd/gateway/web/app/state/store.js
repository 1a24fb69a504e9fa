// What is known: events in, one object out. Pure but for the lists that it appends to.

/** @typedef {import('../types').State} State */

const LOG_LINES = 10_000;
const HAPPENINGS = 2000;
const WAY_POINTS = 5000;
const STEP_M = 0.02;
/** What becomes of a map in the making, beside its cells. */
const OF_MAPS = ['stop_placed', 'loop_held', 'loop_closed', 'reconciled'];
const STATUS_WORDS = ['ok', 'miss', 'too_near', 'weak', 'saturated', 'ambient', 'not_measured', 'timeout', 'device_error'];

/** @returns {State} */
export function nothing() {
  return {
    hello: null, session: null, isOtherLife: false, status: null, mission: null, pose: null, odometry: null, sweep: null,
    progress: null, plan: null, choice: null, exploringEnded: null, happenings: [], way: [], log: [], lost: {}, rank: null, commander: null, wish: null, wishUntil: 0,
    statusAt: -Infinity, odometryAt: -Infinity, questionAt: -Infinity, daemonSilent: null, isOpen: false, lines: [],
  };
}

/**
 * Take a message of the daemon.
 * @param {State} state changed in place
 * @param {import('../types').Frame} frame
 * @param {number} now milliseconds
 */
export function accept(state, frame, now) {
  if (frame.session !== state.session) begin(state, frame.session);
  const fields = frame.fields;
  const take = /** @type {Record<string, () => void>} */ ({
    status: () => takeStatus(state, fields, now),
    mission_progress: () => takeMission(state, fields),
    pose_estimate: () => takePose(state, fields),
    odometry: () => Object.assign(state, { odometry: fields, odometryAt: now - age(state, fields, now) }),
    sweep_begun: () => beginSweep(state, fields.number, fields.total, fields.in_map),
    sweep_readings: () => takeReadings(state, fields),
    sweep_progress: () => takeProgress(state, fields),
    sweep_done: () => takeSweep(state, fields),
    plan: () => takePlan(state, fields),
    stop_chosen: () => takeChoice(state, fields),
    exploring_ended: () => takeExploringEnded(state, fields),
    ...Object.fromEntries(OF_MAPS.map((event) => [event, () => happened(state, event, fields)])),
    rank_map: () => Object.assign(state, { rank: fields }),
    log: () => takeLog(state, fields),
  });
  (take[frame.event] ?? (frame.topic === 'log' ? take['log'] : undefined))?.();
}

/**
 * Take what the gateway says.
 * @param {State} state @param {any} said @param {number} now
 */
export function hear(state, said, now) {
  if (said.type === 'hello') Object.assign(state, { hello: said, questionAt: now });
  if (said.type === 'question') Object.assign(state, { questionAt: now, daemonSilent: said.daemon_silent_s });
  if (said.type === 'commander') {
    Object.assign(state, { commander: said.commander, wish: said.wish, wishUntil: now + 1000 * (said.wish_left_s ?? 0) });
  }
  if (said.type === 'lost') for (const [topic, count] of Object.entries(said.topics)) state.lost[topic] = (state.lost[topic] ?? 0) + count;
}

/** Another life of the daemon: what is known of the first is not of this one. @param {State} state @param {string} session */
function begin(state, session) {
  const { hello, log, lost, commander, happenings, questionAt, isOpen, lines } = state;
  Object.assign(state, nothing(), { hello, log, lost, commander, happenings, questionAt, isOpen, lines, session, isOtherLife: state.session !== null });
}

/** How old a message was when it came, by the robot's clock [ms]. @param {State} state @param {any} fields @param {number} now */
function age(state, fields, now) {
  if (state.hello === null) return 0;
  // What came with the snapshot may be old; what came later is as new as the gateway heard it.
  const then = (fields.time_ns - state.hello.time_ns) / 1e6;
  return Math.max(0, -then);
}

/** @param {State} state @param {any} fields @param {number} now */
function takeStatus(state, fields, now) {
  const before = state.status;
  state.status = fields;
  state.statusAt = now - age(state, fields, now);
  if (fields.mission_id === null) state.progress = null;
  const at = fields.time_ns / 1e9;
  const passed = before === null ? 0 : (fields.time_ns - before.time_ns) / 1e9;
  if (before === null || (passed < 0.5 && state.lines.length > 0)) return; // of one look alone there is no rate
  /** @type {Record<string, number>} */
  const rates = {};
  for (const device of fields.devices) {
    const frames = count(device, 'frames');
    const old = before?.devices.find((one) => one.name === device.name);
    rates[device.name] = old === undefined || passed === 0 ? 0 : Math.max(0, (frames - count(old, 'frames')) / passed);
  }
  state.lines.push({ at, rates, battery: fields.battery_v });
  if (state.lines.length > 900) state.lines.shift();
}

/** @param {import('../types').Device} device @param {string} name */
export function count(device, name) {
  return device.counters.find(([counted]) => counted === name)?.[1] ?? 0;
}

/** @param {State} state @param {any} fields */
function takeMission(state, fields) {
  if (state.mission?.mission_id !== fields.mission_id) {
    state.way = [];
    if (state.plan?.mission_id !== fields.mission_id) state.plan = null;
  }
  if (state.mission?.mission_id !== fields.mission_id || state.mission?.phase !== fields.phase || state.mission?.stop !== fields.stop) happened(state, 'mission_progress', fields);
  state.mission = fields;
}

/** @param {State} state @param {any} fields */
function takeChoice(state, fields) {
  Object.assign(state, { choice: fields, exploringEnded: null });
  happened(state, 'stop_chosen', fields);
}

/** @param {State} state @param {any} fields */
function takeExploringEnded(state, fields) {
  Object.assign(state, { choice: null, exploringEnded: fields });
  happened(state, 'exploring_ended', fields);
}

/** @param {State} state @param {string} event @param {any} fields */
function happened(state, event, fields) {
  state.happenings.push({ time_ns: fields.time_ns, event, fields });
  if (state.happenings.length > HAPPENINGS) state.happenings.splice(0, HAPPENINGS / 10);
}

/** Who joins is told the last plan that there was, of whichever mission. @param {State} state @param {any} fields */
function takePlan(state, fields) {
  if (fields.mission_id >= (state.mission?.mission_id ?? 0)) state.plan = fields;
}

/** @param {State} state @param {any} fields */
function takePose(state, fields) {
  const { best } = fields;
  // A number that is none is no place to draw a robot at.
  const isPlace = best !== null && Number.isFinite(best.x_m + best.y_m + best.heading_rad);
  state.pose = isPlace ? fields : { ...fields, best: null };
  if (!isPlace) return;
  const last = state.way.at(-1);
  if (last === undefined || Math.hypot(fields.best.x_m - last[0], fields.best.y_m - last[1]) >= STEP_M) {
    state.way.push([fields.best.x_m, fields.best.y_m]);
    if (state.way.length > WAY_POINTS) state.way.splice(0, WAY_POINTS / 10);
  }
}

/** @param {State} state @param {number} number @param {number} total @param {import('../types').Pose | null} inMap */
function beginSweep(state, number, total, inMap) {
  state.sweep = { number, total, in_map: inMap, readings: [], is_done: false };
}

/** @param {State} state @param {any} fields */
function takeProgress(state, fields) {
  state.progress = { taken: fields.taken, total: fields.total };
}

/** @param {State} state @param {any} fields */
function takeReadings(state, fields) {
  if (state.sweep?.number !== fields.number) return; // its begin was not heard: the whole comes at its end
  const bearings = floats(fields.bearing_f32le), ranges = floats(fields.range_f32le);
  const xs = floats(fields.origin_x_f32le), ys = floats(fields.origin_y_f32le);
  bearings.forEach((bearing, index) => {
    const range = ranges[index] ?? NaN;
    const status = STATUS_WORDS[fields.status_u8[index]] ?? 'device_error';
    state.sweep?.readings.push({
      bearing_rad: bearing, range_m: Number.isNaN(range) ? null : range, status,
      origin_x_m: xs[index] ?? 0, origin_y_m: ys[index] ?? 0,
    });
  });
}

/** @param {Uint8Array | undefined} bytes */
function floats(bytes) {
  if (bytes === undefined) return new Float32Array(0);
  return new Float32Array(bytes.slice().buffer);
}

/** @param {State} state @param {any} fields */
function takeSweep(state, fields) {
  const before = state.sweep?.number === fields.sweep.number ? state.sweep : null;
  const inMap = fields.in_map ?? before?.in_map ?? null;
  state.sweep = { number: fields.sweep.number, total: fields.sweep.readings.length, in_map: inMap, readings: fields.sweep.readings, is_done: true };
  state.progress = null;
}

/** @param {State} state @param {any} fields */
function takeLog(state, fields) {
  state.log.push(fields);
  if (state.log.length > LOG_LINES) state.log.splice(0, LOG_LINES / 10);
}
