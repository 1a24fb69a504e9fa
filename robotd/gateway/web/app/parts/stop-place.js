// Where STOP is: on every page, above whatever is open, and pressed where it is seen, whatever else lies there.
import { html } from 'lit-html';
import { t } from '../texts/texts.js';

/** @typedef {import('../app.js').App} App */

/** Never disabled, and never asks. @param {App} app */
export function stopButton(app) {
  const { phase, label } = app.stopping;
  return html`<div class="stop-place" popover="manual">
    <button class=${`stop ${phase}`} aria-label=${`${label}. ${t('stop.label')}`}
      @keydown=${(/** @type {KeyboardEvent} */ event) => { if (event.key === 'Enter') { event.preventDefault(); app.stopping.press(); } }}
      @click=${(/** @type {MouseEvent} */ event) => { if (event.detail === 0) app.stopping.press(); }}>${label}</button>
  </div>`;
}

/** Lay STOP into the top layer, once it is on the page. */
export function raiseStop() {
  const place = document.querySelector('.stop-place');
  if (place instanceof HTMLElement && !place.matches(':popover-open')) place.showPopover();
}

/** @param {App} app */
export function guardStop(app) {
  // Before anything on the page, and by where it is: an open dialog takes all that lies outside of it from the pointer.
  addEventListener('pointerdown', (event) => take(app, event), { capture: true });
  new MutationObserver((changes) => {
    if (changes.some(({ target }) => target instanceof HTMLDialogElement && target.open)) raiseAgain();
  }).observe(document, { subtree: true, attributeFilter: ['open'] });
}

/** @param {App} app @param {PointerEvent} event */
function take(app, event) {
  const box = document.querySelector('.stop')?.getBoundingClientRect();
  const { clientX: x, clientY: y } = event;
  if (box === undefined || x < box.left || x > box.right || y < box.top || y > box.bottom) return;
  event.preventDefault();
  event.stopPropagation();
  app.stopping.press();
}

/** Above what was opened since. */
function raiseAgain() {
  const place = document.querySelector('.stop-place');
  if (place instanceof HTMLElement && place.matches(':popover-open')) place.hidePopover();
  raiseStop();
}
