// A button that acts when it is held for a second: by pointer, or by Enter.
import { html } from 'lit-html';

const HELD_MS = 1000;

/**
 * @param {{ label: string, act: () => void, disabled: boolean, describedBy?: string }} button
 */
export function holdButton({ label, act, disabled, describedBy = '' }) {
  /** @param {Event} event */
  const begin = (event) => {
    const button = /** @type {HTMLButtonElement} */ (event.currentTarget);
    if (button.getAttribute('aria-disabled') === 'true' || button.classList.contains('held')) return;
    button.classList.add('held');
    button.dataset['timer'] = String(setTimeout(() => { end(event, button); act(); }, HELD_MS));
  };
  /** @param {Event} event @param {HTMLButtonElement} [given] */
  const end = (event, given) => {
    const button = given ?? /** @type {HTMLButtonElement} */ (event.currentTarget);
    button.classList.remove('held');
    clearTimeout(Number(button.dataset["timer"] ?? 0));
  };
  /** @param {KeyboardEvent} event */
  const key = (event) => {
    if (event.key !== 'Enter') return;
    event.preventDefault();
    if (!event.repeat) begin(event);
  };
  return html`<button class="hold" aria-disabled=${disabled} aria-describedby=${describedBy}
    @pointerdown=${begin} @pointerup=${end} @pointerleave=${end} @pointercancel=${end}
    @keydown=${key} @keyup=${end} @blur=${end} @contextmenu=${(/** @type {Event} */ event) => event.preventDefault()}
    @click=${(/** @type {Event} */ event) => event.preventDefault()}><span>${label}</span></button>`;
}
