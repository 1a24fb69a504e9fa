// An address for Foxglove's app, which can bring no token: for one use, and soon.
import { html, nothing } from 'lit-html';
import { t } from '../texts/texts.js';

/** @typedef {import('../app.js').App} App */

let address = '';

/** @param {App} app */
export function foxgloveCard(app) {
  const ask = async () => {
    const { path } = await app.fetch('api/foxglove', { method: 'POST' });
    const url = new URL(path, document.baseURI);
    url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    address = url.href;
    app.wake(true);
  };
  return html`<section class="card"><h2>${t('fox.title')}</h2><p>${t('fox.hint')}</p>
    <button @click=${() => ask().catch((error) => app.notice('refused', t('refused', { message: error.message })))}>${t('fox.ask')}</button>
    ${address === '' ? nothing : html`<label>${t('fox.address')} <input readonly .value=${address} @focus=${(/** @type {any} */ event) => event.target.select()}></label>`}</section>`;
}
