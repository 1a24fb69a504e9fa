// Log: the daemon's lines as they come, what became of missions, and who did what.
import { html, nothing } from 'lit-html';
import { clock } from '../parts/format.js';
import { t } from '../texts/texts.js';
import { missions } from './log/missions.js';

/** @typedef {import('../app.js').App} App */
/** @typedef {{ time_unix_ns: number, who: string, whence: string, what: string, result: string }} Deed */

const LEVELS = ['INFO', 'WARNING', 'ERROR', 'CRITICAL'];
const SHOWN = 500;
const AGAIN_MS = 3000;
let level = 'INFO';
let search = '';
/** The lines as they were when they were paused. @type {import('../types').LogLine[] | null} */
let paused = null;
/** Which of the three is shown. @type {'daemon' | 'missions' | 'audit'} */
let shown = 'daemon';
/** @type {Deed[]} */
let deeds = [];
let askedAt = -Infinity;

/** @param {App} app */
export function logPage(app) {
  const mayAudit = app.state.hello !== null && app.state.hello.role !== 'viewer';
  const kinds = /** @type {const} */ (['daemon', 'missions', ...(mayAudit ? ['audit'] : [])]);
  const show = (/** @type {typeof shown} */ kind) => { shown = kind; askedAt = -Infinity; app.wake(true); };
  return html`<h1>${t('log.title')}</h1>
    <div class="buttons choice" role="group" aria-label=${t('log.title')}>
      ${kinds.map((kind) => html`<button aria-pressed=${shown === kind} @click=${() => show(/** @type {typeof shown} */ (kind))}>${t(`log.${kind}`)}</button>`)}</div>
    ${shown === 'missions' ? missions(app) : shown === 'audit' && mayAudit ? audit(app) : daemon(app)}`;
}

/** @param {App} app */
function daemon(app) {
  const all = paused ?? app.state.log;
  const least = LEVELS.indexOf(level);
  const wanted = search.toLowerCase();
  const found = all.filter((line) => LEVELS.indexOf(line.level) >= least && (wanted === '' || `${line.logger} ${line.message}`.toLowerCase().includes(wanted)));
  const unix = (/** @type {number} */ ns) => (ns + (app.state.hello?.wall_offset_ns ?? 0)) / 1e9;
  const download = () => {
    const text = found.map((line) => `${new Date(unix(line.time_ns) * 1000).toISOString()} ${line.level} ${line.logger}: ${line.message}\n`).join('');
    const link = Object.assign(document.createElement('a'), { href: URL.createObjectURL(new Blob([text], { type: 'text/plain' })), download: 'robotd.log' });
    link.click();
    URL.revokeObjectURL(link.href);
  };
  const lost = app.state.lost['log'] ?? 0;
  return html`<div class="tools">
      <label class="inline">${t('log.level')} <select @change=${(/** @type {any} */ event) => { level = event.target.value; app.wake(true); }}>${LEVELS.map((one) => html`<option ?selected=${one === level}>${one}</option>`)}</select></label>
      <label class="inline grow">${t('log.search')} <input type="search" .value=${search} @input=${(/** @type {any} */ event) => { search = event.target.value; app.wake(true); }}></label>
      <button aria-pressed=${paused !== null} @click=${() => { paused = paused === null ? [...app.state.log] : null; app.wake(true); }}>${paused === null ? t('log.pause') : t('log.go_on')}</button>
      <button @click=${download}>${t('log.download')}</button></div>
    <p class="quiet" role="status">${t('log.shown', { shown: Math.min(found.length, SHOWN), all: all.length })} ${lost > 0 ? t('log.lost', { count: lost }) : ''}</p>
    <div class="table-scroll lines" tabindex="0" role="region" aria-label=${t('log.title')}><table>
      <thead><tr><th scope="col">${t('log.when')}</th><th scope="col">${t('log.severity')}</th><th scope="col">${t('log.source')}</th><th scope="col">${t('log.message')}</th></tr></thead>
      <tbody>${found.slice(-SHOWN).reverse().map((line) => html`<tr class=${line.level.toLowerCase()}><td class="value">${clock(unix(line.time_ns))}</td><td>${line.level}</td><td class="quiet source">${line.logger.replace('robotd.', '')}</td><td>${line.message}</td></tr>`)}</tbody></table></div>`;
}

/** @param {App} app */
function audit(app) {
  if (performance.now() - askedAt > AGAIN_MS) {
    askedAt = performance.now();
    app.fetch('api/audit').then((answer) => { deeds = answer; app.wake(); }, () => {});
  }
  return html`<div class="table-scroll lines" tabindex="0" role="region" aria-label=${t('log.audit')}><table>
    <thead><tr><th scope="col">${t('log.when')}</th><th scope="col">${t('log.who')}</th><th scope="col">${t('log.whence')}</th><th scope="col">${t('log.what')}</th><th scope="col">${t('log.result')}</th></tr></thead>
    <tbody>${deeds.slice(-SHOWN).reverse().map((deed) => html`<tr><td class="value">${clock(deed.time_unix_ns / 1e9)}</td><td>${deed.who}</td><td class="quiet">${deed.whence}</td><td>${deed.what}</td><td>${deed.result}</td></tr>`)}</tbody></table></div>`;
}
