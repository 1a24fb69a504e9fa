// Who drives what, and how it goes.
import { html, nothing } from 'lit-html';
import { isDriving } from '../../state/words.js';
import { t, word } from '../../texts/texts.js';

/** @typedef {import('../../app.js').App} App */

/** @param {App} app */
export function missionCard(app) {
  const { status, mission } = app.state;
  if (status === null || mission === null) return nothing;
  const isUnderWay = status.mission_id !== null && mission.mission_id === status.mission_id;
  return html`<section class="card" aria-labelledby="mission"><h2 id="mission">${t('mission.title')}</h2>
    ${isUnderWay
      ? html`<p class="big">${word('kind', mission.kind)}: ${word('phase', mission.phase)}</p><p>${mission.message}</p>${driver(app)}`
      : html`<p class="quiet">${t('mission.last', { kind: word('kind', mission.kind), phase: word('phase', mission.phase), message: mission.message })}</p>`}
  </section>`;
}

/** @param {App} app */
function driver(app) {
  const { commander, wish, wishUntil, hello } = app.state;
  if (commander === null) return html`<p>${t('mission.by_program')}</p>`;
  const left = Math.max(0, Math.ceil((wishUntil - performance.now()) / 1000));
  if (isDriving(app.state)) {
    return html`<p>${t('mission.by_you')}</p>${wish === null ? nothing : html`<p role="alert"><strong>${t('mission.asked', { who: wish.who, left })}</strong></p>
      <div class="buttons"><button class="primary" @click=${() => app.ask('hand_over', { give: true })}>${t('mission.give')}</button>
      <button @click=${() => app.ask('hand_over', { give: false })}>${t('mission.keep')}</button></div>`}`;
  }
  const isAsking = wish !== null && wish.browser === hello?.browser;
  const may = hello !== null && hello.role !== 'viewer';
  return html`<p>${t('mission.by', { who: commander.driver.who })}</p>
    ${isAsking ? html`<p>${t('mission.asking', { who: commander.driver.who, left })}</p>`
      : may ? html`<button @click=${() => app.ask('take_over')}>${t('mission.take_over')}</button>` : nothing}`;
}
