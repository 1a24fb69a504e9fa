// Who drives what, and how it goes.
import { html, nothing } from 'lit-html';
import { hindrance } from '../../state/silence.js';
import { isDriving } from '../../state/words.js';
import { t, word } from '../../texts/texts.js';
import { said } from './motion.js';

/** @typedef {import('../../app.js').App} App */

/** @param {App} app */
export function missionCard(app) {
  const { status, mission } = app.state;
  if (status === null || mission === null) return nothing;
  const isUnderWay = status.mission_id !== null && mission.mission_id === status.mission_id;
  return html`<section class="card" aria-labelledby="mission"><h2 id="mission">${t('mission.title')}</h2>
    ${isUnderWay ? underWay(app, mission) : last(app, mission)}
  </section>`;
}

/** @param {App} app @param {import('../../types').Mission} mission */
function underWay(app, mission) {
  const { choice } = app.state;
  const why = mission.kind === 'explore' && choice !== null && !mission.message.includes(choice.reason) ? choice.reason : null;
  const mayPause = mission.kind === 'explore' && isDriving(app.state);
  return html`<p class="big">${word('kind', mission.kind)}: ${word('phase', mission.phase)}</p><p>${mission.message}</p>
    ${why === null ? nothing : html`<p class="quiet">${t('mission.why_there', { why })}</p>`}${driver(app)}
    ${mayPause ? html`<button @click=${() => app.command('stop', { reason: 'paused' })}>${t('mission.pause')}</button>` : nothing}`;
}

/** What came of the last one; one that explored goes on where it ended. @param {App} app @param {import('../../types').Mission} mission */
function last(app, mission) {
  const { status, pose, hello } = app.state;
  const told = html`<p class="quiet">${t('mission.last', { kind: word('kind', mission.kind), phase: word('phase', mission.phase), message: mission.message })}</p>`;
  const goesOn = mission.kind === 'explore' && mission.phase !== 'done' && status?.map_name != null && hello !== null && hello.role !== 'viewer';
  if (!goesOn) return told;
  const why = hindrance(app.state, 'drive', performance.now()) ?? (pose?.best == null ? { why: 'not_localized', remedy: 'localize' } : null);
  const resume = () => why === null && app.mission('explore', { name: status.map_name, resume: true }, true);
  return html`${told}<button aria-disabled=${why !== null} aria-describedby="resume-why" @click=${resume}>${t('act.resume')}</button>${said(why, 'resume-why')}`;
}

/** @param {App} app */
function driver(app) {
  const { commander, wish, wishUntil, hello, status } = app.state;
  if (commander === null) return html`<p>${t('mission.by_program', { who: status?.commander?.client || t('mission.a_program') })}</p>`;
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
