import { html } from 'lit-html';
import { t } from '../texts/texts.js';
/** @param {import('../app.js').App} app */
export function logPage(app) { return html`<h1>${t('page.log')}</h1>`; }
