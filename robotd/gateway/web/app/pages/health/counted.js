// What the daemon counts of itself: how late its loop is, its memory, what it dropped. Asked for while somebody looks.
import { html } from 'lit-html';
import { size } from '../../parts/format.js';
import { t } from '../../texts/texts.js';

/** @typedef {import('../../app.js').App} App */
/** @typedef {{ name: string, labels: Record<string, string>, value: number }} Sample */
/** @typedef {{ name: string, bounds: number[], counts: number[], sum: number }} Buckets */

const AGAIN_MS = 3000;
const SHARE = 0.99;
/** @type {{ counters: Sample[], gauges: Sample[], histograms: Buckets[] } | null} */
let metrics = null;
let askedAt = -Infinity;

/** @param {App} app */
export function countedCard(app) {
  if (performance.now() - askedAt > AGAIN_MS && app.link.isOpen) {
    askedAt = performance.now();
    app.link.ask('command', { cmd: 'metrics' }).then((answer) => { metrics = answer; app.wake(); }, () => {});
  }
  const lag = metrics?.histograms.find(({ name }) => name === 'loop_lag_seconds');
  const memory = metrics?.gauges.filter(({ name }) => name === 'resident_bytes') ?? [];
  const dropped = metrics?.counters.filter(({ name, value }) => name === 'dropped_messages_total' && value > 0) ?? [];
  const within = lag === undefined ? null : boundOf(lag, SHARE);
  return html`<section class="card"><h2>${t('health.counted')}</h2><dl class="facts">
    <dt>${t('health.lag')}</dt><dd class="value">${within === null ? t('health.unknown') : t(Number.isFinite(within) ? 'health.lag_within' : 'health.lag_beyond', { ms: within * 1000, last: (lag?.bounds.at(-1) ?? 0) * 1000 })}</dd>
    <dt>${t('health.memory')}</dt><dd class="value">${memory.length === 0 ? t('health.unknown') : memory.map(({ labels, value }) => `${labels['process']} ${size(value)}`).join(', ')}</dd>
    <dt>${t('health.daemon_dropped')}</dt><dd class="value">${metrics === null ? t('health.unknown') : dropped.map(({ labels, value }) => `${labels['topic']} ${value}`).join(', ') || t('health.nothing')}</dd>
  </dl></section>`;
}

/**
 * Return the least bound that a share of what was observed lies within; null if nothing was observed, Infinity if no bound is so wide.
 * @param {Buckets} buckets @param {number} share
 */
export function boundOf({ bounds, counts }, share) {
  const all = counts.at(-1) ?? 0;
  if (all === 0) return null;
  return bounds.find((_, index) => (counts[index] ?? 0) >= share * all) ?? Infinity;
}
