// Maps: what is stored, the one in use, and what comes from other programs and goes to them.
import { html, nothing } from 'lit-html';
import { metres, when } from '../parts/format.js';
import { typedForm } from '../parts/typed.js';
import { t } from '../texts/texts.js';
import { bringing, NAME } from './maps/bring.js';
import { choose, comparison, isChosen } from './maps/comparing.js';
import { begin, placingCard } from './maps/placing.js';

/** @typedef {import('../app.js').App} App */
/** @typedef {{ name: string, version: number, digest: string, created_unix_ns: number, rows: number, cols: number, resolution_m: number,
 *   damage: string | null, unsaved: boolean, stops: number | null }} Entry */

/** @type {Entry[] | null} */
let entries = null;
/** The map in use, and whether it was saved, when the list was asked for. */
let asked = '';
let saveAs = '';
/** @type {Set<string>} names of which older versions are shown */
const unfolded = new Set();
/** What is typed below a map that is to be renamed or deleted. @type {{ name: string, act: 'rename' | 'delete', typed: string } | null} */
let change = null;

/** @param {App} app */
export function mapsPage(app) {
  const { status } = app.state;
  const now = `${status?.map_id} ${status?.map_unsaved} ${status?.map_kept_version} ${app.state.session}`;
  if (now !== asked && app.link.isOpen) {
    asked = now;
    list(app);
  }
  /** @type {Map<string, Entry[]>} */
  const byName = new Map();
  for (const entry of entries ?? []) byName.set(entry.name, [...(byName.get(entry.name) ?? []), entry]);
  return html`<h1>${t('maps.title')}</h1>${current(app)}${placingCard(app, (entry, more) => load(app, entry, more))}${comparison(app)}${bringing(app, () => { asked = ''; })}
    ${entries !== null && entries.length === 0 ? html`<p class="quiet">${t('maps.none')}</p>` : nothing}
    <div class="cards maps">${[...byName].map(([name, versions]) => card(app, name, versions.sort((a, b) => b.version - a.version)))}</div>`;
}

/** @param {App} app */
async function list(app) {
  try {
    entries = (await app.link.ask('command', { cmd: 'map_list' })).maps;
  } catch {
    asked = ''; // asked again when the page is drawn next
  }
  app.wake(true);
}

/** @param {App} app */
function current(app) {
  const { status, hello } = app.state;
  if (status === null) return nothing;
  const may = hello !== null && hello.role !== 'viewer';
  const isNamed = saveAs === '' || NAME.test(saveAs);
  const save = async () => {
    const saved = await app.command('map_save', saveAs === '' ? {} : { name: saveAs }, '');
    if (saved !== undefined) app.notice('done', t('maps.saved', { version: saved.version }));
    saveAs = '';
  };
  return html`<section class="card current"><p class="big">${status.map_name === null ? t('maps.current_none') : t('maps.current', { name: status.map_name })}</p>
    ${status.map_unsaved ? html`<p class="why">${status.map_kept_version === null ? t('maps.not_kept') : t('maps.not_saved', { version: status.map_kept_version })}</p>` : nothing}
    ${status.map_name !== null && may ? html`<div class="buttons">
      <label class="inline">${t('map.name')} <input placeholder=${status.map_name} .value=${saveAs} maxlength="64" @input=${(/** @type {any} */ event) => { saveAs = event.target.value; app.wake(true); }}></label>
      <button class="primary" aria-disabled=${!isNamed} @click=${() => isNamed && save()}>${saveAs === '' || saveAs === status.map_name ? t('maps.save') : t('maps.save_as')}</button>
      ${status.map_unsaved ? html`<button @click=${() => app.command('map_discard')}>${t('maps.discard')}</button>` : nothing}
    </div>${isNamed ? nothing : html`<p class="why">${t('map.name_bad')}</p>`}` : nothing}
  </section>`;
}

/** @param {App} app @param {string} name @param {Entry[]} versions */
function card(app, name, versions) {
  const newest = versions.find((entry) => !entry.unsaved) ?? versions[0];
  if (newest === undefined) return nothing;
  const others = versions.filter((entry) => entry !== newest);
  return html`<article class="card" aria-label=${name}>
    ${newest.damage === null ? html`<img src=${`api/maps/${name}/${newest.version}.png?small`} alt="" loading="lazy" width="320" height="200">` : html`<div class="no-picture" aria-hidden="true">×</div>`}
    <h2 class="name">${name}</h2>
    ${version(app, newest)}
    ${others.length === 0 ? nothing : html`<button class="link" aria-expanded=${unfolded.has(name)} @click=${() => { if (!unfolded.delete(name)) unfolded.add(name); app.wake(true); }}>${others.length === 1 ? t('maps.older_one') : t('maps.older', { count: others.length })}</button>
      ${unfolded.has(name) ? others.map((entry) => version(app, entry)) : nothing}`}
    ${changes(app, name)}
  </article>`;
}

/** Renaming, and deleting, for which the name has to be typed: it cannot be taken back. @param {App} app @param {string} name */
function changes(app, name) {
  const { hello } = app.state;
  if (hello === null || hello.role === 'viewer') return nothing;
  const begin = (/** @type {'rename' | 'delete'} */ act) => { change = { name, act, typed: '' }; app.wake(true); };
  if (change === null || change.name !== name) {
    return html`<div class="buttons changes"><button @click=${() => begin('rename')}>${t('maps.rename')}</button>
      ${hello.role === 'admin' ? html`<button class="danger" @click=${() => begin('delete')}>${t('maps.delete')}</button>` : nothing}</div>`;
  }
  const { act, typed } = change;
  const isRight = act === 'delete' ? typed === name : NAME.test(typed) && typed !== name;
  const carryOut = async () => {
    const done = await (act === 'delete' ? app.command('map_delete', { name }) : app.command('map_rename', { name, new_name: typed }));
    if (done !== undefined) change = null;
    asked = '';
    app.wake(true);
  };
  const label = act === 'delete' ? t('maps.delete_sure', { name }) : t('maps.new_name');
  return typedForm({
    label, verb: t(`maps.${act}`), typed, isRight, isDangerous: act === 'delete', act: carryOut,
    type: (text) => { if (change !== null) change.typed = text; app.wake(true); },
    end: () => { change = null; app.wake(true); },
  });
}

/** @param {App} app @param {{ name: string, version: number }} entry @param {Record<string, unknown>} more */
async function load(app, { name, version }, more) {
  const loaded = await app.command('map_load', { name, version, ...more }, '');
  if (loaded !== undefined) app.notice('done', t(more['robot_in_map'] === undefined ? 'maps.loaded' : 'maps.loaded_here', { name }));
}

/** @param {App} app @param {Entry} entry */
function version(app, entry) {
  const { status, hello } = app.state;
  const isInUse = status?.map_id === entry.digest && entry.digest !== '';
  const may = hello !== null && hello.role !== 'viewer' && entry.damage === null;
  return html`<div class="version">
    <p><strong>${t('maps.version', { version: entry.version })}</strong>${isInUse ? html` <span class="tag">${t('maps.in_use')}</span>` : nothing}${entry.unsaved ? html` <span class="tag doubt">${t('maps.unsaved')}</span>` : nothing}</p>
    ${entry.damage === null
      ? html`<p class="quiet">${t('maps.size', { cols: entry.cols, rows: entry.rows, cell: metres(entry.resolution_m) })}${entry.stops === null ? '' : `, ${t('maps.stops', { count: entry.stops })}`}<br>${t('maps.made', { when: when(entry.created_unix_ns / 1e9) })}<br><code>${entry.digest.slice(0, 12)}</code></p>`
      : html`<p class="why">${t('maps.damaged', { damage: entry.damage })}</p>`}
    <div class="buttons">
      ${may && !isInUse ? html`<button @click=${() => load(app, entry, {})}>${t('maps.load')}</button>` : nothing}
      ${may ? html`<button @click=${() => begin(app, entry)}>${t('maps.load_here')}</button>` : nothing}
      ${entry.damage === null ? html`<a class="button" href=${`api/maps/${entry.name}/${entry.version}.png`} download=${`${entry.name}-${entry.version}.png`}>${t('maps.picture')}</a><a class="button" href=${`api/maps/${entry.name}/${entry.version}.zip`} download=${`${entry.name}-${entry.version}.zip`}>${t('maps.export')}</a>
        <button aria-pressed=${isChosen(entry)} @click=${() => choose(app, entry)}>${t('maps.compare')}</button>` : nothing}
    </div></div>`;
}
