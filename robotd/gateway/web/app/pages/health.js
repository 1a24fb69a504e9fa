import { html } from 'lit-html';
import { t } from '../texts/texts.js';
/** @param {import('../app.js').App} app */
export function healthPage(app) { return html`<h1>${t('page.health')}</h1>`; }
