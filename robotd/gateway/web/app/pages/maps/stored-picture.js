// A stored map, fetched to be looked at: its cells from its picture, where they lie from its yaml.

/**
 * Row 0 is the lowest y.
 * @typedef {{ label: string, rows: number, cols: number, resolution_m: number, origin_x_m: number, origin_y_m: number, cells: Uint8Array }} StoredPicture
 */

/** @param {{ name: string, version: number }} entry @returns {Promise<StoredPicture>} */
export async function fetched({ name, version }) {
  const path = `api/maps/${name}/${version}`;
  const [picture, yaml] = await Promise.all([pixels(`${path}.png`), text(`${path}.yaml`)]);
  const { rows, cols } = picture;
  return { label: `${name} ${version}`, rows, cols, cells: cellsOf(picture), ...placed(yaml) };
}

/** Where a yaml of map_server says that a picture lies. @param {string} yaml */
export function placed(yaml) {
  const resolution = Number(/^resolution:\s*(\S+)/m.exec(yaml)?.[1]);
  const origin = /^origin:\s*\[([^,]+),([^,\]]+)/m.exec(yaml);
  const [x, y] = [Number(origin?.[1]), Number(origin?.[2])];
  if (!(resolution > 0 && Number.isFinite(x) && Number.isFinite(y))) throw new TypeError('its yaml says nowhere where it lies');
  return { resolution_m: resolution, origin_x_m: x, origin_y_m: y };
}

/** Cells of a picture, whose first row is the highest y, and in which dark is a wall. @param {{ rows: number, cols: number, data: Uint8ClampedArray }} picture */
function cellsOf({ rows, cols, data }) {
  const cells = new Uint8Array(rows * cols);
  for (let row = 0; row < rows; row++) {
    for (let col = 0; col < cols; col++) cells[row * cols + col] = 255 - (data[4 * ((rows - 1 - row) * cols + col)] ?? 0);
  }
  return cells;
}

/** @param {string} path */
async function pixels(path) {
  const bitmap = await createImageBitmap(await (await asked(path)).blob(), { colorSpaceConversion: 'none' });
  const { width: cols, height: rows } = bitmap;
  const context = new OffscreenCanvas(cols, rows).getContext('2d');
  if (context === null) throw new TypeError('no picture can be drawn here');
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  return { rows, cols, data: context.getImageData(0, 0, cols, rows).data };
}

/** @param {string} path */
const text = async (path) => (await asked(path)).text();

/** @param {string} path */
async function asked(path) {
  const answer = await fetch(path);
  if (!answer.ok) throw new TypeError((await answer.json()).message);
  return answer;
}
