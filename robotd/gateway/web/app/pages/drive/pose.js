// Where the robot is, in numbers; all places that remain, as a table.
import { html, nothing } from 'lit-html';
import { degrees, place } from '../../parts/format.js';
import { t } from '../../texts/texts.js';

/** @typedef {import('../../app.js').App} App */

/** @param {App} app */
export function poseCard(app) {
  const { pose } = app.state;
  if (pose === null || app.state.status?.map_id == null) return nothing;
  const { best, regions } = pose;
  return html`<section class="card" aria-labelledby="pose"><h2 id="pose">${t('pose.title')}</h2>
    ${best === null ? nothing : html`<p class="big value">${t('pose.at', { x: place(best.x_m), y: place(best.y_m), heading: degrees(best.heading_rad) })}</p>`}
    ${pose.readings > 0 ? html`<p class="value">${t('pose.explained', { rank: pose.best_rank, readings: pose.readings })}</p>` : nothing}
    ${best === null && regions.length === 0 ? html`<p>${t('pose.none')}</p>` : nothing}
    ${regions.length === 0 ? nothing : html`<table><caption>${t('pose.regions')}</caption>
      <thead><tr><th scope="col">${t('pose.number')}</th><th scope="col">${t('pose.place')}</th><th scope="col">${t('pose.belief')}</th><th scope="col">${t('pose.rank')}</th></tr></thead>
      <tbody>${regions.map((region, index) => html`<tr><td>${index + 1}</td><td class="value">${t('pose.at', { x: place(region.pose.x_m), y: place(region.pose.y_m), heading: degrees(region.pose.heading_rad) })}</td><td>${Math.round(region.belief * 100)} %</td><td>${region.best_rank}</td></tr>`)}</tbody></table>
      ${pose.regions_left_out > 0 ? html`<p class="quiet">${t('pose.left_out', { count: pose.regions_left_out })}</p>` : nothing}`}
  </section>`;
}
