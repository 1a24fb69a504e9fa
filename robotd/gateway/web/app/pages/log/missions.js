// What became of missions, and of the maps that they made, since this page was opened.
import { html } from 'lit-html';
import { clock, metres, place } from '../../parts/format.js';
import { t, word } from '../../texts/texts.js';

/** @typedef {import('../../app.js').App} App */

const SHOWN = 500;

/** @param {App} app */
export function missions(app) {
  const offset = app.state.hello?.wall_offset_ns ?? 0;
  return html`<div class="table-scroll lines" tabindex="0" role="region" aria-label=${t('log.missions')}><table>
    <thead><tr><th scope="col">${t('log.when')}</th><th scope="col">${t('log.what')}</th><th scope="col">${t('log.message')}</th></tr></thead>
    <tbody>${app.state.happenings.slice(-SHOWN).reverse().map((one) => html`<tr class=${one.fields.phase === 'failed' ? 'error' : ''}>
      <td class="value">${clock((one.time_ns + offset) / 1e9)}</td>${told(one)}</tr>`)}</tbody></table></div>`;
}

/** @param {import('../../types').Happening} happening */
function told({ event, fields }) {
  const [what, message] = wordsOf(event, fields);
  return html`<td>${what}</td><td>${message}</td>`;
}

/** @param {string} event @param {any} fields @returns {[string, string]} */
function wordsOf(event, fields) {
  if (event === 'mission_progress') {
    const stop = fields.stops > 1 ? ` ${t('head.stop_of', { stop: Math.min(fields.stop + 1, fields.stops), stops: fields.stops })}` : '';
    return [`${fields.mission_id} ${word('kind', fields.kind)}: ${word('phase', fields.phase)}${stop}`, fields.message];
  }
  if (event === 'stop_chosen') return [t('log.chosen', { x: place(fields.x_m), y: place(fields.y_m) }), fields.reason];
  if (event === 'exploring_ended') return [t('log.explored'), t('log.explored_how', { ending: word('ending', fields.ending), stops: fields.stops, way: metres(fields.way_m), seen: fields.seen_m2.toFixed(0), left: fields.left.length })];
  if (event === 'stop_placed') return [t('log.placed', { stop: fields.stop + 1 }), `${word('outcome', fields.outcome)}, ${t('log.explained', { explained: Math.round(100 * fields.explained), against: Math.round(100 * fields.contradicted) })}`];
  if (event === 'reconciled') return [t('log.reconciled'), t('log.moved', { stops: fields.stops_moved, move: metres(fields.largest_move_m) })];
  return [t(`log.${event}`, { stop: fields.stop + 1, old: fields.old_stop + 1 }), t('log.by', { move: metres(fields.moved_m) })];
}
