// What every page has: head, banners, STOP.
import { html, nothing } from 'lit-html';
import { drivePage } from '../pages/drive.js';
import { healthPage } from '../pages/health.js';
import { logPage } from '../pages/log.js';
import { mapsPage } from '../pages/maps.js';
import { recordingsPage } from '../pages/recordings.js';
import { settingsPage } from '../pages/settings.js';
import { silent } from '../state/silence.js';
import { isDriving, whereabouts } from '../state/words.js';
import { t, word } from '../texts/texts.js';
import { age } from './format.js';
import { mark } from './marks.js';
import { signInPage } from './sign-in.js';
import { stopButton } from './stop-place.js';

/** @typedef {import('../app.js').App} App */

const PAGES = /** @type {Record<string, (app: App) => unknown>} */ ({
  drive: drivePage, maps: mapsPage, recordings: recordingsPage, health: healthPage, log: logPage, settings: settingsPage,
});
/** The console that this page is; another one is offered, never forced. @type {string | null} */
let loaded = null;

/** @param {App} app */
export function page(app) {
  if (app.who === null) return html`${banners(app)}${signInPage(app)}${notices(app)}${app.state.session === null ? nothing : stopButton(app)}`;
  loaded ??= app.state.hello?.console ?? null;
  const silence = silent(app.state, performance.now());
  const draw = PAGES[app.page] ?? drivePage;
  return html`
    <a class="skip" href="#main" @click=${toMain}>${t('nav.skip')}</a>
    <header class=${silence === null ? '' : 'stale'}>
      <div class="top">
        <span class="robot">${app.who.robot}</span>
        ${standing(app)}
        <nav aria-label=${t('nav.label')}>
          ${Object.keys(PAGES).map((name) => html`<a href=${`#/${name}`} aria-current=${app.page === name ? 'page' : 'false'}>${t(`page.${name}`)}</a>`)}
        </nav>
      </div>
    </header>
    ${banners(app)}
    <main id="main" tabindex="0" class=${`page-${app.page} ${silence === null ? '' : 'stale'}`}>${draw(app)}</main>
    ${notices(app)}
    ${stopButton(app)}`;
}

/** @param {Event} event */
function toMain(event) {
  event.preventDefault();
  document.getElementById('main')?.focus();
}

/** The first look: where it is, what it does, how old that is. @param {App} app */
function standing(app) {
  const { state } = app;
  const { word: where, places, mark: shape } = whereabouts(state);
  const silence = silent(state, performance.now());
  const { status, mission } = state;
  const isUnderWay = status?.mission_id != null && mission?.mission_id === status.mission_id;
  const since = Math.max(0, performance.now() - state.statusAt) / 1000;
  return html`
    <div class="standing">
      <p class=${`where ${where}`} role="status">${mark(shape)}<span>${where === 'ambiguous' && places < 2 ? t(places === 0 ? 'where.ambiguous_beyond' : 'where.ambiguous_one') : t(`where.${where}`, { places })}</span></p>
      <p class=${`mode ${status?.mode ?? ''}`}><strong>${status === null ? '…' : word('mode', status.mode)}</strong> <span class="reason" title=${status?.reason ?? ''}>${status?.reason ?? ''}</span></p>
      <p class="doing">
        ${isUnderWay && mission.stops > 1 ? html`<span>${t('head.stop_of', { stop: Math.min(mission.stop + 1, mission.stops), stops: mission.stops })}</span>` : nothing}
        ${isUnderWay && state.progress !== null ? html`<progress max=${state.progress.total} value=${state.progress.taken} aria-label=${t('head.readings', state.progress)}></progress>` : nothing}
        ${status?.held ? html`<span class="held">${t('head.held', { why: status.held })}</span>` : nothing}
        ${state.commander !== null && !state.commander.attended ? html`<strong class="unattended">${t('head.unattended')}</strong>` : nothing}
      </p>
      <p class="vital">
        <span>${status?.battery_v == null ? t('head.battery_unknown') : t('head.battery', { volts: status.battery_v.toFixed(1) })}</span>
        <span class="age">${silence === null && status !== null ? t('head.fresh') : status === null ? '' : t('head.age', { age: age(since) })}</span>
      </p>
    </div>`;
}

/** @param {App} app */
function banners(app) {
  const { state, stopping } = app;
  const silence = app.who === null ? null : silent(state, performance.now());
  const isOld = loaded !== null && state.hello !== null && state.hello.console !== loaded;
  return html`<div class="banners">
    <div role="alert">
      ${stopping.phase === 'unconfirmed' ? html`<p class="banner danger">${t('stop.unconfirmed')}</p>` : nothing}
      ${state.status?.mode === 'fault' && app.who !== null ? html`<p class="banner fault">${t('head.fault', { why: state.status.reason })}</p>` : nothing}
      ${silence === null ? nothing : html`<p class="banner warning">${Number.isFinite(silence.seconds) ? t(`silent.${silence.part}`, { age: age(silence.seconds) }) : t('silent.daemon_never')}</p>`}
      ${isDriving(state) && document.hidden ? html`<p class="banner warning">${t('hidden', { age: '' })}</p>` : nothing}
    </div>
    ${app.hiddenFor > 0 ? html`<p class="banner">${t('hidden', { age: age(app.hiddenFor) })} <button @click=${() => { app.hiddenFor = 0; app.wake(true); }}>${t('understood')}</button></p>` : nothing}
    ${state.isOtherLife ? html`<p class="banner">${t('other_life')} <button @click=${() => { state.isOtherLife = false; app.wake(true); }}>${t('understood')}</button></p>` : nothing}
    ${isOld ? html`<p class="banner">${t('new_console')} <button @click=${() => location.reload()}>${t('new_console.load')}</button></p>` : nothing}
  </div>`;
}

/** @param {App} app */
function notices(app) {
  return html`<div class="notices" aria-live="polite">
    ${app.notices.map((notice) => html`<p class=${`notice ${notice.kind}`}>${notice.text}<button aria-label=${t('close')} @click=${() => app.dismiss(notice.id)}>×</button></p>`)}
  </div>`;
}
