// Arming and disarming: two acts, and what each means is said before.
import { html, nothing } from 'lit-html';
import { holdButton } from '../../parts/hold.js';
import { hindrance } from '../../state/silence.js';
import { t } from '../../texts/texts.js';

/** @typedef {import('../../app.js').App} App */

/** @param {App} app */
export function motionCard(app) {
  const { status } = app.state;
  if (status === null) return nothing;
  const isArmed = status.mode !== 'disarmed' && status.mode !== 'fault';
  return html`<section class="card motion" aria-labelledby="motion"><h2 id="motion">${t('arm.title')}</h2>
    ${isArmed ? armed(app) : status.mode === 'fault' ? faulty(app) : disarmed(app)}</section>`;
}

/** @param {App} app */
function armed(app) {
  return html`<p>${t('arm.is_armed')}</p><button @click=${() => app.command('disarm')}>${t('arm.disarm')}</button>`;
}

/** @param {App} app */
function faulty(app) {
  const why = hindrance(app.state, 'clear', performance.now());
  return html`<p>${t('arm.is_fault')}</p>${faults(app)}
    <button aria-disabled=${why !== null} @click=${() => why === null && app.command('clear')}>${t('arm.clear')}</button>${said(why, 'clear-why')}`;
}

/** @param {App} app */
function disarmed(app) {
  const { status } = app.state;
  const ready = status?.devices.filter((device) => device.link === 'ready').map((device) => device.name) ?? [];
  const battery = status?.battery_v == null ? t('head.battery_unknown') : t('head.battery', { volts: status.battery_v.toFixed(1) });
  const why = hindrance(app.state, 'arm', performance.now());
  return html`<p>${t('arm.is_disarmed')} ${t('arm.will', { devices: ready.join(', ') || t('arm.none'), battery })}</p>${faults(app)}
    ${holdButton({ label: t('arm.arm'), act: () => app.command('arm'), disabled: why !== null, describedBy: 'arm-why' })}${said(why, 'arm-why')}`;
}

/** @param {App} app */
function faults(app) {
  const found = app.state.status?.devices.filter((device) => device.faults.length > 0) ?? [];
  if (found.length === 0) return nothing;
  return html`<ul class="faults">${found.map((device) => html`<li><strong>${device.name}</strong>: ${device.faults.join(', ')}</li>`)}</ul>`;
}

/** Why something cannot be done, and what helps. @param {{ why: string, remedy: string } | null} why @param {string} id */
export function said(why, id) {
  return html`<p class="why" id=${id}>${why === null ? '' : `${t(`why.${why.why}`)} ${t(`remedy.${why.remedy}`)}`}</p>`;
}
