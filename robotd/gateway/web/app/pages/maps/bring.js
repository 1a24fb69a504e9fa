// A map of another program: its files are looked at first, and stored when somebody has seen what they are.
import { html, nothing } from 'lit-html';
import { metres } from '../../parts/format.js';
import { t } from '../../texts/texts.js';

/** @typedef {import('../../app.js').App} App */
/** @typedef {{ rows: number, cols: number, resolution_m: number, free_cells: number, unknown_cells: number, occupied_cells: number, notes: string[] }} Found */

export const NAME = /^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$/;
/** What was chosen, what it is called, and what the gateway found in it. @type {{ files: File[], name: string, resolution: string, found: Found | null, isBusy: boolean }} */
let chosen = { files: [], name: '', resolution: '', found: null, isBusy: false };

/** @param {App} app @param {() => void} stored is told when there is a new map */
export function bringing(app, stored) {
  const { hello } = app.state;
  if (hello === null || hello.role === 'viewer') return nothing;
  const isPicture = chosen.files.length === 1 && /\.(pgm|png|bmp)$/i.test(chosen.files[0]?.name ?? '');
  const isRight = chosen.found !== null && NAME.test(chosen.name) && !chosen.isBusy;
  const store = async () => {
    const answer = await send(app, { name: chosen.name });
    if (answer === null) return;
    app.notice('done', t('bring.stored', { name: answer.map.name, version: answer.map.version }));
    chosen = { files: [], name: '', resolution: '', found: null, isBusy: false };
    stored();
    app.wake(true);
  };
  return html`<form class="card bring" @submit=${(/** @type {Event} */ event) => { event.preventDefault(); if (isRight) store(); }}>
    <h2>${t('bring.title')}</h2>
    <label>${t('bring.files')} <input type="file" multiple accept=".yaml,.yml,.pgm,.png,.bmp,.zip" @change=${(/** @type {any} */ event) => choose(app, [...event.target.files])}></label>
    ${isPicture ? html`<label>${t('bring.resolution')} <input inputmode="decimal" .value=${chosen.resolution} @change=${(/** @type {any} */ event) => { chosen.resolution = event.target.value; look(app); }}></label>` : nothing}
    <div role="status">${chosen.found === null ? nothing : seen(chosen.found)}</div>
    ${chosen.found === null ? nothing : html`<label>${t('map.name')} <input .value=${chosen.name} maxlength="64" @input=${(/** @type {any} */ event) => { chosen.name = event.target.value; app.wake(true); }}></label>
      <div class="buttons"><button class="primary" aria-disabled=${!isRight}>${t('bring.store')}</button></div>`}
  </form>`;
}

/** @param {Found} found */
function seen(found) {
  const all = found.rows * found.cols;
  const share = (/** @type {number} */ cells) => `${Math.round((100 * cells) / all)} %`;
  return html`<p>${t('maps.size', { cols: found.cols, rows: found.rows, cell: metres(found.resolution_m) })}<br>
    <span class="quiet">${t('bring.counts', { free: share(found.free_cells), walls: share(found.occupied_cells), unseen: share(found.unknown_cells) })}</span></p>
    ${found.notes.map((note) => html`<p class="why">${note}</p>`)}`;
}

/** @param {App} app @param {File[]} files */
function choose(app, files) {
  const named = files.find((file) => /\.(ya?ml|zip)$/i.test(file.name)) ?? files[0];
  const stem = (named?.name ?? '').replace(/\.[^.]*$/, '');
  chosen = { files, name: NAME.test(stem) ? stem : '', resolution: '', found: null, isBusy: false };
  look(app);
}

/** Ask what the files are; nothing is stored. @param {App} app */
async function look(app) {
  chosen.found = null;
  const isBare = chosen.files.length === 1 && /\.(pgm|png|bmp)$/i.test(chosen.files[0]?.name ?? '');
  if (chosen.files.length > 0 && !(isBare && chosen.resolution === '')) chosen.found = await send(app, {});
  app.wake(true);
}

/** Return the gateway's answer; null if it refused, which is shown. @param {App} app @param {Record<string, string>} more */
async function send(app, more) {
  const body = new FormData();
  for (const file of chosen.files) body.append('file', file, file.name);
  const asked = new URLSearchParams(chosen.resolution === '' ? more : { ...more, resolution_m: chosen.resolution });
  chosen.isBusy = true;
  app.wake(true);
  try {
    return await app.fetch(`api/maps?${asked}`, { method: 'POST', body });
  } catch (error) {
    app.notice('refused', t('refused', { message: error instanceof Error ? error.message : String(error) }));
    return null;
  } finally {
    chosen.isBusy = false;
  }
}
