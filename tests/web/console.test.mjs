// The console's own parts without a browser: `make ui-test` runs them by `node --test`.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { crc32 } from 'node:zlib';

import { compared, KINDS } from '../../robotd/gateway/web/app/map/compare.js';
import { Grid, unpacked } from '../../robotd/gateway/web/app/map/grid.js';
import { distances } from '../../robotd/gateway/web/app/map/overlays.js';
import { boundsOf, colours, paint } from '../../robotd/gateway/web/app/map/paint.js';
import { levelOf, tilesIn } from '../../robotd/gateway/web/app/map/tiles.js';
import { fitted, toMap, toPixel, zoomed } from '../../robotd/gateway/web/app/map/view.js';
import { boundOf } from '../../robotd/gateway/web/app/pages/health/counted.js';
import { placed } from '../../robotd/gateway/web/app/pages/maps/stored-picture.js';
import { Stopping } from '../../robotd/gateway/web/app/parts/stopping.js';
import { accept, hear, nothing } from '../../robotd/gateway/web/app/state/store.js';
import { hindrance, silent } from '../../robotd/gateway/web/app/state/silence.js';
import { isDriving, whereabouts } from '../../robotd/gateway/web/app/state/words.js';
import { en } from '../../robotd/gateway/web/app/texts/en.js';
import { waitMs } from '../../robotd/gateway/web/app/wire/backoff.js';
import { readFrame } from '../../robotd/gateway/web/app/wire/decode.js';

const vectors = JSON.parse(readFileSync(process.env.ROBOTD_VECTORS, 'utf8'));
const bytes = (name) => Uint8Array.from(Buffer.from(vectors[name], 'base64')).buffer;
const frame = (name) => readFrame(bytes(name));

test('a frame that Python packed is read', () => {
  const pose = frame('pose');
  assert.deepEqual([pose.topic, pose.event, pose.session, pose.seq], ['pose', 'pose_estimate', 'session', 412]);
  assert.equal(pose.fields.best.x_m, 1.25);
  assert.equal(pose.fields.time_ns, 2 ** 53 - 1);
});

test('what is cut, damaged, of another kind or version is no frame, and throws nothing', () => {
  const whole = new Uint8Array(bytes('pose'));
  for (let length = 0; length < whole.length; length++) assert.equal(readFrame(whole.slice(0, length).buffer), null);
  assert.equal(readFrame(Uint8Array.from([2, ...whole.slice(1)]).buffer), null);
  const other = Buffer.from(whole);
  other[other.indexOf('v') + 1] = 2;
  assert.equal(readFrame(Uint8Array.from(other).buffer), null);
});

test('a whole map and a change are laid in; gaps wait for the whole', async () => {
  const grid = new Grid();
  await grid.accept(frame('change').fields);
  assert.equal(grid.placement, null, 'a change of an unknown map is none');
  await grid.accept(frame('whole').fields);
  assert.equal(grid.cells.reduce((sum, value) => sum + value, 0), vectors.sum_before);
  const before = grid.version;
  await grid.accept(frame('change').fields);
  assert.equal(crc32(grid.cells), vectors.crc_after);
  assert.deepEqual([0, 1, 2, 3].filter((tile) => grid.tileVersion(tile) > before), [0, 3], '700 x 530 cells are 2 x 2 tiles');
  await grid.accept({ ...frame('change').fields, generation: 9 });
  assert.equal(grid.generation, 5);
  await grid.accept({ map_id: null });
  assert.equal(grid.placement, null);
});

test('a map that is larger than it says, or than any, is left out', async () => {
  const fields = frame('whole').fields;
  await assert.rejects(unpacked(fields.cells_zlib, 100), RangeError);
  await assert.rejects(unpacked(fields.cells_zlib, 700 * 530 + 1), RangeError);
  const grid = new Grid();
  await grid.accept({ ...fields, rows: 100_000, cols: 100_000 });
  assert.equal(grid.placement, null);
});

test('tiles are what a slow twin paints, at each level, and no wall is lost', () => {
  const rows = 1400, cols = 1100;
  const cells = Uint8Array.from({ length: rows * cols }, (_, n) => (n * 7919) % 251 === 0 ? 200 : 128 - ((n * 31) % 100));
  const table = colours({ free: [1, 2, 3], wall: [250, 251, 252], unknown: [100, 100, 100] });
  for (const [level, tile] of [[0, 0], [0, 8], [1, 1], [1, 3], [2, 0], [3, 0]]) {
    const bounds = boundsOf(tile, level, { rows, cols }), { block } = bounds;
    const high = Math.ceil(bounds.height / block), wide = Math.ceil(bounds.width / block);
    const pixels = new Uint32Array(wide * high);
    paint(pixels, cells, cols, bounds, table);
    for (const [row, col] of [[0, 0], [high - 1, wide - 1], [high >> 1, wide >> 1], [0, wide - 1]]) {
      const found = [];
      for (let r = bounds.row + row * block; r < Math.min(rows, bounds.row + (row + 1) * block); r++) {
        for (let c = bounds.col + col * block; c < Math.min(cols, bounds.col + (col + 1) * block); c++) found.push(cells[r * cols + c]);
      }
      const wanted = found.some((value) => value > 128) ? Math.max(...found) : Math.min(...found);
      assert.equal(pixels[(high - 1 - row) * wide + col], table[wanted], `${level} ${tile} ${row} ${col}`);
    }
  }
});

test('a picture has no more pixels than the screen has for it', () => {
  assert.deepEqual([2, 1, 0.9, 0.5, 0.3, 0.001].map(levelOf), [0, 0, 1, 1, 2, 6]);
});

test('distances are those of a slow twin, within 2 %', () => {
  const rows = 40, cols = 50;
  const walls = [[3, 4], [30, 44], [20, 20]];
  const cells = new Uint8Array(rows * cols);
  for (const [row, col] of walls) cells[row * cols + col] = 255;
  const far = distances(cells, rows, cols);
  for (let row = 0; row < rows; row++) {
    for (let col = 0; col < cols; col++) {
      const exact = Math.min(...walls.map(([r, c]) => Math.hypot(row - r, col - c)));
      assert.ok(Math.abs(far[row * cols + col] - exact) <= 0.02 * exact + 1e-6, `${row} ${col}`);
    }
  }
});

test('a place stays below the pointer while it is zoomed, and a pixel leads back', () => {
  const size = { width: 800, height: 600 }, view = { x: 3, y: -2, scale: 55 };
  const near = zoomed(view, size, 1.7, 123, 456);
  const before = toMap(view, size, 123, 456), after = toMap(near, size, 123, 456);
  assert.ok(Math.hypot(before.x - after.x, before.y - after.y) < 1e-9);
  const { px, py } = toPixel(view, size, before.x, before.y);
  assert.ok(Math.hypot(px - 123, py - 456) < 1e-9);
  assert.ok(fitted({ x0: 0, y0: 0, x1: 10, y1: 2 }, size).scale * 10 <= 800);
});

const device = (name, more = {}) => ({ name, link: 'ready', armed: false, faults: [], detail: '', counters: [], ...more });
const status = (more = {}) => ({
  event: 'status', time_ns: 1e9, mode: 'disarmed', reason: '', devices: [device('drive')], battery_v: 24, bumpers_rad: [], mission_id: null,
  map_id: 'm', map_name: 'm', recording: null, held: null, map_unsaved: false, map_kept_version: null, since_ns: 0, started_ns: 0, ...more,
});
const told = (event, fields, session = 's') => ({ topic: event, event, session, seq: 1, fields: { event, ...fields } });
const greeted = (now) => {
  const state = nothing();
  hear(state, { type: 'hello', time_ns: 0, role: 'operator', browser: 'b', commands: [], console: 'c' }, now);
  state.isOpen = true;
  return state;
};

test('age decides what is fresh, and names who is silent', () => {
  const state = greeted(0);
  accept(state, told('status', status()), 0);
  hear(state, { type: 'question', daemon_silent_s: 0.1 }, 1000);
  assert.equal(silent(state, 1400), null);
  assert.equal(silent(state, 2600).part, 'gateway');
  hear(state, { type: 'question', daemon_silent_s: 2.6 }, 2600);
  assert.deepEqual(silent(state, 2600), { part: 'daemon', seconds: 2.6 });
  state.isOpen = false;
  assert.equal(silent(state, 2700).part, 'page');
});

test('an armed base without odometry is silent', () => {
  const state = greeted(0);
  accept(state, told('status', status({ mode: 'idle', devices: [device('drive', { armed: true })] })), 0);
  accept(state, told('odometry', { time_ns: 1e9, in_odom: {} }), 0);
  assert.equal(silent(state, 900), null);
  assert.equal(silent(state, 1200).part, 'base');
});

test('what came with the snapshot is as old as it is', () => {
  const state = nothing();
  hear(state, { type: 'hello', time_ns: 10e9, role: 'viewer' }, 0);
  state.isOpen = true;
  accept(state, told('status', status({ time_ns: 5e9 })), 100);
  assert.equal(silent(state, 100).part, 'daemon');
});

test('what cannot be done says why and what helps', () => {
  const state = greeted(0);
  assert.equal(hindrance(state, 'arm', 0).why, 'silent');
  accept(state, told('status', status()), 0);
  assert.equal(hindrance(state, 'arm', 0), null);
  assert.equal(hindrance(state, 'drive', 0).remedy, 'arm');
  accept(state, told('status', status({ mode: 'fault' })), 0);
  assert.equal(hindrance(state, 'arm', 0).remedy, 'clear');
  assert.equal(hindrance(state, 'clear', 0), null);
  state.hello.role = 'viewer';
  assert.equal(hindrance(state, 'clear', 0).why, 'viewer');
  for (const name of ['silent', 'viewer', 'no_fault', 'fault', 'armed', 'no_device', 'disarmed', 'busy', 'no_map', 'not_localized']) assert.ok(en[`why.${name}`]);
});

test('another life of the daemon takes map, way and plan with it', () => {
  const state = greeted(0);
  accept(state, told('status', status()), 0);
  accept(state, told('pose_estimate', { time_ns: 0, state: 'localized', best: { x_m: 1, y_m: 2, heading_rad: 0 }, regions: [], final: true }), 0);
  accept(state, told('plan', { mission_id: 1, stops: [] }), 0);
  assert.deepEqual([state.way.length, state.isOtherLife], [1, false]);
  accept(state, told('odometry', { time_ns: 0 }, 'another'), 0);
  assert.deepEqual([state.way.length, state.plan, state.status, state.isOtherLife], [0, null, null, true]);
  assert.equal(state.hello.browser, 'b');
});

test('readings of a sweep come in columns, and the whole in the end', () => {
  const state = greeted(0);
  accept(state, frame('readings'), 0);
  assert.equal(state.sweep, null, 'its begin was not heard');
  accept(state, told('sweep_begun', { number: 3, total: 300, in_map: { x_m: 0, y_m: 0, heading_rad: 0 } }, 'session'), 0);
  accept(state, frame('readings'), 0);
  assert.deepEqual(state.sweep.readings.map(({ range_m, status }) => [range_m, status]), [[2.5, 'ok'], [null, 'weak']]);
});

test('one word for where it is, with a shape of its own', () => {
  const state = greeted(0);
  const shapes = new Set();
  accept(state, told('status', status()), 0);
  for (const word of ['localized', 'predicted', 'ambiguous', 'lost']) {
    accept(state, told('pose_estimate', { time_ns: 0, state: word, best: null, regions: [1, 2, 3], regions_left_out: 0 }), 0);
    const found = whereabouts(state);
    assert.deepEqual([found.word, found.places], [word, 3]);
    shapes.add(found.mark);
  }
  assert.equal(shapes.size, 4);
  accept(state, told('status', status({ map_id: null })), 0);
  assert.equal(whereabouts(state).word, 'no_map');
});

test('who drives is the browser that the gateway names', () => {
  const state = greeted(0);
  hear(state, { type: 'commander', commander: { driver: { browser: 'b', who: 'anna' } }, wish: null, wish_left_s: null }, 0);
  assert.ok(isDriving(state));
  hear(state, { type: 'commander', commander: { driver: { browser: 'x', who: 'otto' } }, wish: null, wish_left_s: null }, 0);
  assert.ok(!isDriving(state));
});

test('tries come later and later, up to a bound, and not all at once', () => {
  assert.deepEqual([0, 1, 2, 9].map((failed) => waitMs(failed, 0.5)), [250, 500, 1000, 5000]);
  assert.ok(waitMs(9, 1) <= 6250 && waitMs(0, 0) >= 187);
});

test('STOP is said again and again until it is confirmed, and once more for as long when it is pressed again', (context) => {
  let now = 0, said = 0, alarms = 0;
  context.mock.timers.enable({ apis: ['setInterval', 'setTimeout'] });
  context.mock.method(performance, 'now', () => now);
  const pass = (ms) => { for (let at = 0; at < ms; at += 100) { now += 100; context.mock.timers.tick(100); } };
  const stopping = new Stopping({ say: () => { said += 1; return true; }, post: () => new Promise(() => {}), changed: () => {}, alarm: () => { alarms += 1; } });
  stopping.press();
  pass(200);
  stopping.press(); // a key that is held
  pass(200);
  assert.deepEqual([stopping.phase, alarms], ['unconfirmed', 1]);
  pass(5000);
  const before = said;
  stopping.press();
  pass(1000);
  assert.ok(said - before >= 10, `${said - before} times in a second`);
  assert.equal(stopping.phase, 'unconfirmed', 'it is not true that it stops now');
  stopping.confirmed();
  assert.equal(stopping.phase, 'stopped');
});

test('a plan of an earlier mission, which a page that joins is told, is not drawn', () => {
  const told = (topic, event, fields) => ({ topic, event, session: 'a', seq: 1, fields });
  const state = nothing();
  accept(state, told('mission', 'mission_progress', { mission_id: 6, phase: 'done' }), 0);
  accept(state, told('mission', 'plan', { mission_id: 5, stops: [{ x_m: 1, y_m: 2, state: 'swept' }] }), 0);
  assert.equal(state.plan, null);
  accept(state, told('mission', 'plan', { mission_id: 7, stops: [] }), 0);
  accept(state, told('mission', 'mission_progress', { mission_id: 7, phase: 'started' }), 0);
  assert.equal(state.plan.mission_id, 7);
});

test('a pose that is no number is no place', () => {
  const state = greeted(0);
  accept(state, told('pose_estimate', { time_ns: 0, state: 'localized', best: { x_m: NaN, y_m: 2, heading_rad: 0 }, regions: [], final: true }), 0);
  assert.equal(state.pose.best, null);
  assert.equal(state.way.length, 0);
});

test('two maps are compared where they lie, whatever their cells', () => {
  const map = (resolution_m, origin_x_m, cells) => ({ label: '', rows: 1, cols: cells.length, resolution_m, origin_x_m, origin_y_m: 0, cells: Uint8Array.from(cells) });
  const coarse = map(0.2, 0, [0, 255]), fine = map(0.1, 0.1, [0, 128, 255, 255]);
  const { cols, kinds } = compared(coarse, fine);
  // From 0 to 0.5 m, a tenth each: beside each other as the first and the second say.
  assert.equal(cols, 5);
  assert.deepEqual([...kinds].slice(0, cols).map((kind) => KINDS[kind]), ['seen_first', 'free', 'wall_first', 'wall', 'wall_second']);
});

test('a yaml says where a picture lies, or is none', () => {
  assert.deepEqual(placed('image: a.pgm\nresolution: 0.05\norigin: [-1.5, 2.0, 0.0]\n'), { resolution_m: 0.05, origin_x_m: -1.5, origin_y_m: 2 });
  for (const yaml of ['', 'resolution: 0.05\n', 'resolution: nan\norigin: [0, 0, 0]\n', 'resolution: 0.05\norigin: [a, 0, 0]\n']) assert.throws(() => placed(yaml), TypeError);
});

test('how late a loop is, is told by the bound that nearly all lie within', () => {
  const buckets = (counts) => ({ name: 'loop_lag_seconds', bounds: [0.001, 0.01, 0.1], counts, sum: 1 });
  assert.equal(boundOf(buckets([90, 99, 100, 100]), 0.99), 0.01);
  assert.equal(boundOf(buckets([0, 0, 0, 3]), 0.99), Infinity);
  assert.equal(boundOf(buckets([0, 0, 0, 0]), 0.99), null);
});

test('only tiles that are seen are drawn, those in the middle first', () => {
  const place = { rows: 4096, cols: 4096, resolution_m: 0.05, origin_x_m: -102.4, origin_y_m: -102.4, map_id: 'm' };
  const side = 512 * 0.05;
  assert.deepEqual(tilesIn(place, 0, { x0: -1, y0: -1, x1: 1, y1: 1 }).sort((a, b) => a - b), [27, 28, 35, 36]);
  assert.equal(tilesIn(place, 0, { x0: -1e6, y0: -1e6, x1: 1e6, y1: 1e6 }).length, 64);
  assert.equal(tilesIn(place, 3, { x0: -1e6, y0: -1e6, x1: 1e6, y1: 1e6 }).length, 1);
  assert.equal(tilesIn(place, 0, { x0: 500, y0: 500, x1: 600, y1: 600 }).length, 0);
  assert.equal(tilesIn(place, 0, { x0: -1.5 * side, y0: 0.1, x1: 1.5 * side, y1: 0.2 })[0], 35, 'the nearest to the middle');
});

test('what becomes of a mission is kept, each step once', () => {
  const state = greeted(0);
  const step = (phase, stop, message) => accept(state, told('mission_progress', { time_ns: 0, mission_id: 1, kind: 'explore', phase, stop, stops: 9, message }), 0);
  step('started', 0, ''); step('driving', 0, '1 m'); step('driving', 0, '2 m'); step('driving', 1, ''); step('done', 1, '');
  accept(state, told('stop_chosen', { time_ns: 0, map_id: 'm', stop: 1, candidates: [], tour_m: [], reason: 'it is near' }), 0);
  accept(state, told('exploring_ended', { time_ns: 0, map_id: 'm', left: [] }), 0);
  assert.deepEqual(state.happenings.map(({ event, fields }) => fields.phase ?? event), ['started', 'driving', 'driving', 'done', 'stop_chosen', 'exploring_ended']);
  assert.equal(state.choice, null);
});

test('a recorded session ends as the robot ended, whatever frames come twice', async () => {
  const ends = async (frames) => {
    const state = greeted(0), grid = new Grid();
    for (const data of frames) {
      const told = readFrame(Uint8Array.from(Buffer.from(data, 'base64')).buffer);
      accept(state, told, 0);
      if (told.event === 'map_changed') await grid.accept(told.fields);
    }
    const { best } = state.pose;
    return { map: crc32(grid.cells), best: [best.x_m, best.y_m, best.heading_rad], mission: [state.mission.mission_id, state.mission.kind, state.mission.phase], mode: state.status.mode };
  };
  const wanted = { map: vectors.session_map_crc, best: vectors.session_best, mission: vectors.session_mission, mode: vectors.session_mode };
  assert.deepEqual(await ends(vectors.session), wanted);
  assert.deepEqual(await ends([...vectors.session, ...vectors.session.slice(-20)]), wanted);
});
