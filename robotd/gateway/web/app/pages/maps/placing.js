// Loading a map and saying where the robot stands on it: by a drag on its picture, or in numbers.
import { html, nothing } from 'lit-html';
import { ref } from 'lit-html/directives/ref.js';
import { inSight } from '../../parts/in-sight.js';
import { t } from '../../texts/texts.js';
import { fetched } from './stored-picture.js';

/** @typedef {import('../../app.js').App} App */
/** @typedef {{ name: string, version: number }} Entry */

/** What is being placed on which map; x and y in metres, the heading in degrees. @type {{ entry: Entry, picture: import('./stored-picture.js').StoredPicture, x: number, y: number, degrees: number } | null} */
let placing = null;

/** @param {App} app @param {Entry} entry */
export async function begin(app, entry) {
  try {
    const picture = await fetched(entry);
    const middle = { x: picture.origin_x_m + 0.5 * picture.cols * picture.resolution_m, y: picture.origin_y_m + 0.5 * picture.rows * picture.resolution_m };
    placing = { entry, picture, x: round(middle.x), y: round(middle.y), degrees: 0 };
  } catch (error) {
    app.notice('refused', t('refused', { message: error instanceof Error ? error.message : String(error) }));
  }
  app.wake(true);
}

/** @param {App} app @param {(entry: Entry, more: Record<string, unknown>) => Promise<void>} load */
export function placingCard(app, load) {
  if (placing === null) return nothing;
  const { entry, x, y, degrees } = placing;
  const end = () => { placing = null; app.wake(true); };
  const isRight = [x, y, degrees].every(Number.isFinite);
  const carryOut = async () => {
    await load(entry, { robot_in_map: { x_m: x, y_m: y, heading_rad: (degrees * Math.PI) / 180 } });
    end();
  };
  const field = (/** @type {'x' | 'y' | 'degrees'} */ name, /** @type {number} */ value) => html`<label class="inline">${t(`placing.${name}`)}
    <input inputmode="decimal" .value=${String(value)} @change=${(/** @type {any} */ event) => { if (placing !== null) placing[name] = Number.parseFloat(event.target.value); app.wake(true); }}></label>`;
  return html`<form class="card bench" ${ref(inSight)} @submit=${(/** @type {Event} */ event) => { event.preventDefault(); if (isRight) carryOut(); }}>
    <h2 class="name">${t('placing.title', { name: entry.name, version: entry.version })}</h2><p>${t('placing.how')}</p>
    <canvas class="picture" aria-hidden="true" ${ref((element) => listen(app, element))}></canvas>
    <div class="tools">${field('x', x)}${field('y', y)}${field('degrees', degrees)}</div>
    <div class="buttons"><button class="primary" aria-disabled=${!isRight}>${t('maps.load')}</button><button type="button" @click=${end}>${t('cancel')}</button></div></form>`;
}

/** @param {App} app @param {Element | undefined} element */
function listen(app, element) {
  if (!(element instanceof HTMLCanvasElement)) return;
  draw(element);
  if (element.onpointerdown !== null) return;
  const at = (/** @type {PointerEvent} */ event) => {
    const box = element.getBoundingClientRect(), picture = placing?.picture;
    if (picture === undefined) return null;
    const side = (picture.cols * picture.resolution_m) / box.width;
    return { x: picture.origin_x_m + (event.clientX - box.left) * side, y: picture.origin_y_m + picture.rows * picture.resolution_m - (event.clientY - box.top) * side };
  };
  element.onpointerdown = (event) => {
    const place = at(event);
    if (placing === null || place === null) return;
    element.setPointerCapture(event.pointerId);
    Object.assign(placing, { x: round(place.x), y: round(place.y) });
    app.wake(true);
  };
  element.onpointermove = (event) => {
    const place = at(event);
    if (placing === null || place === null || event.buttons === 0) return;
    placing.degrees = Math.round((Math.atan2(place.y - placing.y, place.x - placing.x) * 180) / Math.PI);
    app.wake(true);
  };
}

/** The map, and on it the robot, which looks where its line leads. @param {HTMLCanvasElement} element */
function draw(element) {
  if (placing === null) return;
  const { picture, x, y, degrees } = placing;
  const { rows, cols, cells, resolution_m: side } = picture;
  if (element.width !== cols || element.height !== rows) [element.width, element.height] = [cols, rows];
  const context = element.getContext('2d');
  if (context === null) return;
  const image = context.createImageData(cols, rows);
  for (let row = 0; row < rows; row++) {
    for (let col = 0; col < cols; col++) {
      const grey = 255 - (cells[row * cols + col] ?? 128), pixel = 4 * ((rows - 1 - row) * cols + col);
      image.data[pixel] = image.data[pixel + 1] = image.data[pixel + 2] = grey;
      image.data[pixel + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
  const long = 0.08 * Math.max(rows, cols), [px, py] = [(x - picture.origin_x_m) / side, rows - (y - picture.origin_y_m) / side];
  const angle = (degrees * Math.PI) / 180;
  context.strokeStyle = context.fillStyle = '#c24a00';
  context.lineWidth = Math.max(1, 0.2 * long);
  context.beginPath();
  context.arc(px, py, 0.35 * long, 0, 2 * Math.PI);
  context.fill();
  context.beginPath();
  context.moveTo(px, py);
  context.lineTo(px + long * Math.cos(angle), py - long * Math.sin(angle));
  context.stroke();
}

/** @param {number} metres */
const round = (metres) => Math.round(metres * 100) / 100;
