// Recordings: one under way, and those that can be fetched.
import { html, nothing } from 'lit-html';
import { size, when } from '../parts/format.js';
import { t } from '../texts/texts.js';

/** @typedef {import('../app.js').App} App */

const AGAIN_MS = 5000;
/** @type {{ name: string, bytes: number, changed_unix_s: number }[] | null} */
let found = null;
let askedAt = -Infinity;

/** @param {App} app */
export function recordingsPage(app) {
  if (performance.now() - askedAt > AGAIN_MS) {
    askedAt = performance.now();
    app.fetch('api/recordings').then((answer) => { found = answer.recordings; app.wake(); }, () => {});
  }
  const { status, hello } = app.state;
  const may = hello !== null && hello.role !== 'viewer';
  const under = status?.recording ?? null;
  return html`<h1>${t('rec.title')}</h1>
    <section class="card"><p>${under === null ? t('rec.not') : t('rec.running', { path: under })}</p>
      ${may ? html`<button @click=${() => { askedAt = -Infinity; app.command(under === null ? 'record_start' : 'record_stop'); }}>${under === null ? t('rec.start') : t('rec.stop')}</button>` : nothing}</section>
    <section class="card table-scroll">${found === null || found.length === 0 ? html`<p class="quiet">${t('rec.none')}</p>` : html`
      <table><thead><tr><th scope="col">${t('rec.file')}</th><th scope="col">${t('rec.size')}</th><th scope="col">${t('rec.changed')}</th><th scope="col"></th></tr></thead>
      <tbody>${found.map((file) => html`<tr><td>${file.name}${under?.endsWith(`/${file.name}`) ? html` <span class="tag">${t('rec.now')}</span>` : nothing}</td><td class="value">${size(file.bytes)}</td><td class="value">${when(file.changed_unix_s)}</td>
        <td><a class="button" href=${`api/recordings/${file.name}`} download=${file.name}>${t('rec.download')}</a></td></tr>`)}</tbody></table>`}</section>`;
}
