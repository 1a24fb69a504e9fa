// Health: what the robot can do now and why not, its lines, and how they were of late.
import { html, nothing } from 'lit-html';
import { ref } from 'lit-html/directives/ref.js';
import { curves } from '../parts/curves.js';
import { age } from '../parts/format.js';
import { hindrance } from '../state/silence.js';
import { count } from '../state/store.js';
import { t, word } from '../texts/texts.js';
import { countedCard } from './health/counted.js';

/** @typedef {import('../app.js').App} App */

/** @param {App} app */
export function healthPage(app) {
  const { status, lost, hello } = app.state;
  if (status === null) return html`<h1>${t('health.title')}</h1>`;
  const up = status.started_ns === null ? null : (status.time_ns - status.started_ns) / 1e9;
  const dropped = Object.entries(lost).map(([topic, count]) => `${topic} ${count}`).join(', ');
  return html`<h1>${t('health.title')}</h1>
    <section class="card"><h2>${t('health.why')}</h2><ul class="can">${able(app)}</ul></section>
    <section class="card table-scroll"><h2>${t('health.lines')}</h2>${lines(app)}</section>
    <section class="card"><h2>${t('health.curves')}</h2>
      <figure><figcaption>${t('health.rates')}</figcaption><div class="curves" ${ref((element) => curves(element, app, 'rates'))}></div></figure>
      <figure><figcaption>${t('health.volts')}</figcaption><div class="curves" ${ref((element) => curves(element, app, 'battery'))}></div></figure></section>
    ${countedCard(app)}
    <section class="card"><p>${up === null ? nothing : t('health.up', { age: age(up) })}</p>
      <p class="quiet">${dropped === '' ? t('health.none_dropped') : t('health.dropped', { topics: dropped })}</p>
      <p class="quiet">${hello === null ? nothing : t('set.gateway', { version: hello.gateway, console: hello.console })}</p></section>`;
}

/** @param {App} app */
function able(app) {
  const { status, pose } = app.state;
  const now = performance.now();
  const drive = hindrance(app.state, 'drive', now);
  const localize = drive ?? (status?.map_id === null ? { why: 'no_map', remedy: 'load' } : null);
  const go = localize ?? (pose?.best == null ? { why: 'not_localized', remedy: 'localize' } : null);
  const acts = /** @type {const} */ ([['arm', hindrance(app.state, 'arm', now)], ['localize', localize], ['drive', go]]);
  return acts.map(([act, why]) => html`<li class=${why === null || why.why === 'armed' ? 'yes' : 'no'}>${why === null
    ? t('health.can', { act: t(`health.${act}`) })
    : why.why === 'armed' ? t('why.armed') : t('health.cannot', { act: t(`health.${act}`), why: t(`why.${why.why}`), remedy: t(`remedy.${why.remedy}`) })}</li>`);
}

/** @param {App} app */
function lines(app) {
  const rates = app.state.lines.at(-1)?.rates ?? {};
  const heads = ['device', 'link', 'motion', 'rate', 'errors', 'retries', 'round', 'clock', 'faults', 'detail'];
  return html`<table><thead><tr>${heads.map((head) => html`<th scope="col">${t(`health.${head}`)}</th>`)}</tr></thead>
    <tbody>${app.state.status?.devices.map((device) => {
      const round = count(device, 'clock_round_trip_us'), fast = count(device, 'clock_fast_ppb');
      const errors = device.counters.filter(([name]) => /error|lost|damaged|implausible|garbage|skipped/.test(name)).reduce((sum, [, many]) => sum + many, 0);
      return html`<tr><th scope="row">${device.name}</th><td class=${`link ${device.link}`}>${word('link', device.link)}</td><td>${device.armed ? t('health.armed') : t('health.disarmed')}</td>
        <td class="value">${(rates[device.name] ?? 0).toFixed(0)}</td><td class="value">${errors}</td><td class="value">${count(device, 'retries')}</td>
        <td class="value">${round === 0 ? '' : t('health.ms', { ms: (round / 1000).toFixed(1) })}</td><td class="value">${fast === 0 ? '' : t(fast > 0 ? 'health.ppm' : 'health.ppm_slow', { ppm: Math.abs(fast / 1000).toFixed(0) })}</td>
        <td>${device.faults.join(', ')}</td><td class="quiet">${device.detail}</td></tr>`;
    })}</tbody></table>`;
}
