// What can be started: each act says what it needs, is prepared on the map, and starts with a second press.
import { html, nothing } from 'lit-html';
import { metres, place } from '../../parts/format.js';
import { hindrance } from '../../state/silence.js';
import { t } from '../../texts/texts.js';
import { draftOf } from './draft.js';
import { said } from './motion.js';

/** @typedef {import('../../app.js').App} App */

const NAME = /^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$/;

/** @param {App} app */
export function actsCard(app) {
  listen(app);
  const draft = draftOf(app);
  const { status, hello } = app.state;
  if (status === null || hello === null || hello.role === 'viewer') return nothing;
  const now = performance.now();
  const drive = hindrance(app.state, 'drive', now);
  const onMap = drive ?? (status.map_id === null ? { why: 'no_map', remedy: 'load' } : null);
  const goes = onMap ?? (app.state.pose?.best == null ? { why: 'not_localized', remedy: 'localize' } : null);
  return html`<section class="card acts" aria-labelledby="acts"><h2 id="acts">${t('act.title')}</h2>
    ${draft.act === null ? html`
      <div class="acts-list">
        ${act(app, 'where', onMap, () => start(app, 'localize', { heading: 'unknown' }))}
        ${act(app, 'here', onMap, () => draft.begin('here'))}
        ${act(app, 'go', goes, () => draft.begin('go'))}
        ${act(app, 'map', drive, () => draft.begin('map'))}
        ${hello.commands.includes('explore') ? act(app, 'explore', drive, () => draft.begin('explore')) : nothing}
      </div>
      ${said(drive, 'acts-why')}` : prepared(app, goes, onMap, drive)}
    ${attended(app)}
  </section>`;
}

let isListening = false;
/** `G` from anywhere on the page. @param {App} app */
function listen(app) {
  if (isListening) return;
  isListening = true;
  document.addEventListener('robotd:go', () => {
    draftOf(app).begin('go');
    /** @type {HTMLElement | null} */ (document.querySelector('.view'))?.focus();
  });
}

/** @param {App} app @param {string} name @param {{ why: string, remedy: string } | null} why @param {() => void} begin */
function act(app, name, why, begin) {
  const text = why === null ? t(`act.${name}_hint`) : `${t(`why.${why.why}`)} ${t(`remedy.${why.remedy}`)}`;
  return html`<button class="act" aria-disabled=${why !== null} @click=${() => why === null && begin()}><strong>${t(`act.${name}`)}</strong><span>${text}</span></button>`;
}

/** @param {App} app @param {any} goes @param {any} onMap @param {any} drive */
function prepared(app, goes, onMap, drive) {
  const draft = draftOf(app);
  const parts = { go: () => going(app, goes), here: () => here(app, onMap), map: () => mapping(app, drive), explore: () => exploring(app, drive) };
  return html`${draft.act === null ? nothing : parts[draft.act]()}<button @click=${() => draft.cancel()}>${t('act.cancel')}</button>`;
}

/** @param {App} app @param {any} why */
function going(app, why) {
  const draft = draftOf(app);
  if (draft.goal === null) return html`<p>${t('go.pick')}</p>${said(why, 'go-why')}`;
  const { goal, way } = draft;
  const at = { x: place(goal.x), y: place(goal.y) };
  if (way === null) return html`<p>${t('go.asking')}</p>`;
  if (way?.reason) {
    const nearest = way.nearest_m;
    return html`<p class="why">${t('go.none', { why: way.message || way.reason })}</p>
      ${nearest ? html`<button @click=${() => draft.aim({ x: nearest[0], y: nearest[1] })}>${t('go.nearest', { x: place(nearest[0]), y: place(nearest[1]) })}</button>` : nothing}`;
  }
  const text = way === undefined ? t('go.blind', at) : t('go.length', { ...at, length: metres(way.length_m) });
  return html`<p>${text}</p><button class="primary" aria-disabled=${why !== null} @click=${() => why === null && start(app, 'drive_to', { x_m: goal.x, y_m: goal.y })}>${t('act.go_now')}</button>${said(why, 'go-why')}`;
}

/** @param {App} app @param {any} why */
function here(app, why) {
  const { disk } = draftOf(app);
  if (disk === null) return html`<p>${t('here.draw')}</p>`;
  const within = { x_m: disk.x, y_m: disk.y, radius_m: disk.radius };
  return html`<p>${t('here.disk', { radius: metres(disk.radius), x: place(disk.x), y: place(disk.y) })}</p>
    <button class="primary" aria-disabled=${why !== null} @click=${() => why === null && start(app, 'localize', { heading: 'unknown', within })}>${t('act.start')}</button>${said(why, 'here-why')}`;
}

/** @param {App} app @param {any} why */
function exploring(app, why) {
  const draft = draftOf(app);
  const { status, pose } = app.state;
  const isNamed = NAME.test(draft.name);
  const goesOn = status?.map_name != null && pose?.best != null && draft.name === status.map_name;
  return html`${nameField(app)}
    <p class="quiet">${goesOn ? t('explore.goes_on') : t('map.start_zero')}</p>
    <button class="primary" aria-disabled=${why !== null || !isNamed} @click=${() => why === null && isNamed && start(app, 'explore', { name: draft.name, resume: goesOn })}>${goesOn ? t('act.resume') : t('act.start')}</button>${said(why, 'explore-why')}`;
}

/** @param {App} app */
function nameField(app) {
  const draft = draftOf(app);
  return html`<label>${t('map.name')} <input .value=${draft.name} maxlength="64" aria-describedby="name-why" @input=${(/** @type {any} */ event) => { draft.name = event.target.value; app.wake(true); }}></label>
    <p class="why" id="name-why">${draft.name === '' || NAME.test(draft.name) ? '' : t('map.name_bad')}</p>`;
}

/** @param {App} app @param {any} why */
function mapping(app, why) {
  const draft = draftOf(app);
  const isNamed = NAME.test(draft.name);
  const begins = draft.start ?? app.state.pose?.best ?? { x_m: 0, y_m: 0, heading_rad: 0 };
  /** @param {number} from @param {number} to */
  const move = (from, to) => {
    const stops = [...draft.stops];
    const [moved] = stops.splice(from, 1);
    if (moved !== undefined && to >= 0 && to < draft.stops.length) {
      stops.splice(to, 0, moved);
      draft.stops = stops;
    }
    app.canvas?.wake();
    app.wake(true);
  };
  return html`
    ${nameField(app)}
    <p>${t('map.stops_hint')}</p>
    <ol class="stops">${draft.stops.map((stop, index) => html`
      <li draggable="true" @dragstart=${(/** @type {DragEvent} */ event) => event.dataTransfer?.setData('text/plain', String(index))}
        @dragover=${(/** @type {DragEvent} */ event) => event.preventDefault()}
        @drop=${(/** @type {DragEvent} */ event) => { event.preventDefault(); move(Number(event.dataTransfer?.getData('text/plain')), index); }}>
        <span>${t('map.stop', { n: index + 1, x: place(stop.x), y: place(stop.y) })}</span>
        <button aria-label=${t('map.up')} @click=${() => move(index, index - 1)}>↑</button>
        <button aria-label=${t('map.down')} @click=${() => move(index, index + 1)}>↓</button>
        <button aria-label=${t('map.remove')} @click=${() => { draft.stops = draft.stops.filter((_, n) => n !== index); app.canvas?.wake(); app.wake(true); }}>×</button>
      </li>`)}</ol>
    ${startPose(app, begins)}
    <button class="primary" aria-disabled=${why !== null || !isNamed} @click=${() => why === null && isNamed && start(app, 'map_start', {
      name: draft.name, stops_m: draft.stops.map(({ x, y }) => [x, y]), start: begins,
    })}>${t('act.start')}</button>${said(why, 'map-why')}`;
}

/** Where the robot stands on the new map, which fixes its frame: where it is believed to be now, unless somebody says otherwise. @param {App} app @param {import('../../types').Pose} begins */
function startPose(app, begins) {
  const field = (/** @type {keyof typeof begins} */ name, /** @type {string} */ text, scale = 1) => html`<label>${t(text)} <input inputmode="decimal" .value=${String(Math.round(begins[name] * scale * 100) / 100)} @change=${(/** @type {any} */ event) => {
    const typed = Number.parseFloat(event.target.value) / scale;
    if (Number.isFinite(typed)) draftOf(app).start = { ...begins, [name]: typed };
    app.wake(true);
  }}></label>`;
  return html`<fieldset class="start"><legend>${t('map.begins')}</legend>${field('x_m', 'placing.x')}${field('y_m', 'placing.y')}${field('heading_rad', 'placing.degrees', 180 / Math.PI)}</fieldset>`;
}

/** @param {App} app */
function attended(app) {
  const draft = draftOf(app);
  if (!app.state.hello?.unattended) return nothing;
  return html`<label class="check"><input type="checkbox" .checked=${draft.unattended} @change=${(/** @type {any} */ event) => { draft.unattended = event.target.checked; }}> ${t('mission.unattended')}</label>`;
}

/** @param {App} app @param {string} cmd @param {Record<string, unknown>} args */
async function start(app, cmd, args) {
  const draft = draftOf(app);
  const started = await app.mission(cmd, args, !draft.unattended);
  if (started !== undefined) draft.cancel();
}
