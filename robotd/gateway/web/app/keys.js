// Keys that work everywhere: Escape and Space stop.

/** @typedef {import('./app.js').App} App */

const FIELDS = 'input, textarea, select, [contenteditable]';
const LAYERS = /** @type {Record<string, string>} */ ({ 1: 'rank', 2: 'belief', 3: 'sweep', 4: 'way', 5: 'plan', 6: 'clearance' });

/** @param {App} app */
export function bindKeys(app) {
  // While it is caught, before anything on the page: no dialog and no field may keep a stop for itself.
  addEventListener('keydown', (event) => take(app, event), { capture: true });
}

/** @param {App} app @param {KeyboardEvent} event */
function take(app, event) {
  const isInField = event.target instanceof Element && event.target.closest(FIELDS) !== null;
  if (event.key === 'Escape' || (event.key === ' ' && !isInField)) {
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat) app.stopping.press();
    return;
  }
  if (isInField || event.ctrlKey || event.altKey || event.metaKey || app.page !== 'drive' || app.canvas === null) return;
  const layer = LAYERS[event.key];
  if (layer !== undefined) app.canvas.toggle(layer);
  else if (event.key === 'f' || event.key === 'F') app.canvas.follow();
  else if (event.key === 'g' || event.key === 'G') document.dispatchEvent(new CustomEvent('robotd:go'));
  else return;
  event.preventDefault();
  app.wake(true);
}
