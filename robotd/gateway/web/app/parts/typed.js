// A form for what cannot be taken back, or needs a name: it acts when what is typed is right.
import { html } from 'lit-html';
import { t } from '../texts/texts.js';

/**
 * @param {{ label: string, verb: string, typed: string, isRight: boolean, isDangerous: boolean, type: (typed: string) => void, act: () => void, end: () => void }} form
 */
export function typedForm({ label, verb, typed, isRight, isDangerous, type, act, end }) {
  return html`<form class="changes" @submit=${(/** @type {Event} */ event) => { event.preventDefault(); if (isRight) act(); }}>
    <label>${label} <input .value=${typed} maxlength="128" @input=${(/** @type {any} */ event) => type(event.target.value)}></label>
    <div class="buttons"><button class=${isDangerous ? 'danger' : 'primary'} aria-disabled=${!isRight}>${verb}</button>
    <button type="button" @click=${end}>${t('cancel')}</button></div></form>`;
}
