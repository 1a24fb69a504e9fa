import { html } from 'lit-html';
import { t } from '../texts/texts.js';
/** @param {import('../app.js').App} app */
export function recordingsPage(app) { return html`<h1>${t('page.recordings')}</h1>`; }
