// Drive: the map, and beside it motion, the mission, what to do, and where the robot is.
import { html, nothing } from 'lit-html';
import { ref } from 'lit-html/directives/ref.js';
import { LAYERS } from '../map/layers.js';
import { MapCanvas } from '../map/canvas.js';
import { place } from '../parts/format.js';
import { t } from '../texts/texts.js';
import { actsCard } from './drive/acts.js';
import { draftOf } from './drive/draft.js';
import { missionCard } from './drive/mission.js';
import { motionCard } from './drive/motion.js';
import { poseCard } from './drive/pose.js';

/** @typedef {import('../app.js').App} App */

/** What is told of the map on its edge, past the panel: it changes with each move of the pointer. @type {{ coordinates: HTMLElement | null, scale: HTMLElement | null }} */
const told = { coordinates: null, scale: null };
/** Layers that a narrow screen has no room for are folded. */
const isWide = matchMedia('(min-width: 721px)').matches;

/** @param {App} app */
export function drivePage(app) {
  if (app.canvas !== null) app.canvas.robotRadius = app.robotRadius;
  return html`
    <h1 class="unseen">${t('page.drive')}</h1>
    <section class="map" aria-label=${t('page.drive')}>
      <div class="view" tabindex="0" role="application" aria-label=${t('map.label')} ${ref(mounted(app))}></div>
      ${app.grid.placement === null && app.state.status !== null && app.state.status.map_id === null
        ? html`<div class="no-map"><p>${t('map.none')}</p><p class="quiet">${t('map.none_hint')}</p></div>` : nothing}
      <div class="map-tools">
        <div class="buttons">
          <button @click=${() => zoom(app, '+')} aria-label=${t('map.in')}>+</button>
          <button @click=${() => zoom(app, '-')} aria-label=${t('map.out')}>−</button>
          <button @click=${() => app.canvas?.fit()} title=${`${t('map.fit')} (0)`}>${t('map.fit')}</button>
          <button aria-pressed=${app.canvas?.follows ?? false} @click=${() => { app.canvas?.follow(); app.wake(true); }} title="F">${t('map.follow')}</button>
        </div>
        <details class="layers" ?open=${isWide}><summary>${t('map.layers')}</summary>
          ${LAYERS.map(({ name, key }) => html`<label><input type="checkbox" .checked=${app.canvas?.shown.has(name) ?? false} @change=${() => { app.canvas?.toggle(name); app.wake(true); }}><span class=${`swatch ${name}`}></span>${t(`layer.${name}`)} <kbd>${key}</kbd></label>`)}
        </details>
      </div>
      <p class="scale" aria-hidden="true" ${ref(scaleAt)}></p>
      <p class="coordinates" ${ref(coordinatesAt)}></p>
    </section>
    <aside class="panel">${motionCard(app)}${missionCard(app)}${actsCard(app)}${poseCard(app)}</aside>`;
}

/** @param {App} app @param {Element | undefined} element */
function mount(app, element) {
  if (!(element instanceof HTMLElement)) {
    app.canvas = null;
    return;
  }
  if (app.canvas !== null) return;
  const before = kept;
  app.canvas = new MapCanvas(element, app.state, app.grid);
  if (before !== null) app.canvas.resume(before);
  kept = app.canvas;
  app.canvas.onLayers = () => app.look();
  app.canvas.draft = (pen) => draftOf(app).paint(pen);
  app.canvas.onPoint = (at) => tell(app, at);
  app.canvas.onScale = (step, px) => {
    if (told.scale === null) return;
    told.scale.style.width = `${px}px`;
    told.scale.textContent = step >= 1 ? `${step} m` : `${Math.round(step * 100)} cm`;
  };
  draftOf(app).listen();
}

/** @type {((element: Element | undefined) => void) | null} */
let mounting = null;
/** The same function each time the page is drawn: another one would be told that the canvas is gone and here again. @param {App} app */
function mounted(app) {
  mounting ??= (element) => mount(app, element);
  return mounting;
}

/** The map as it was looked at when another page was opened. @type {MapCanvas | null} */
let kept = null;

/** @param {Element | undefined} element */
const scaleAt = (element) => { told.scale = /** @type {HTMLElement} */ (element ?? null); };
/** @param {Element | undefined} element */
const coordinatesAt = (element) => { told.coordinates = /** @type {HTMLElement} */ (element ?? null); };

/** @param {App} app @param {{ x: number, y: number } | null} at */
function tell(app, at) {
  const { coordinates } = told;
  if (coordinates === null) return;
  if (at === null) {
    coordinates.textContent = '';
    return;
  }
  const value = app.grid.valueAt(at.x, at.y);
  const said = value === null ? '' : value === 128 ? t('map.unseen') : `${value < 128 ? t('map.free') : t('map.wall')} ${Math.round((value / 255) * 100)} %`;
  coordinates.textContent = `(${place(at.x)}, ${place(at.y)}) ${said}`;
}

/** @param {App} app @param {string} key */
function zoom(app, key) {
  document.querySelector('.view')?.dispatchEvent(new KeyboardEvent('keydown', { key }));
  app.wake(true);
}
