// Curves of the last quarter of an hour; what draws them is loaded only where they are looked at.

/** @typedef {import('../app.js').App} App */

const COLOURS = ['#5cb0ff', '#ffb454', '#9aa7b5'];
const AGAIN_MS = 1000;
/** @type {WeakMap<Element, { plot: any, at: number, width: number }>} */
const plots = new WeakMap();
/** @type {Promise<any> | null} */
let loading = null;

/** @param {Element | undefined} element @param {App} app @param {'rates' | 'battery'} what */
export async function curves(element, app, what) {
  if (!(element instanceof HTMLElement)) return;
  loading ??= import('uplot').then((module) => module.default);
  const Plot = await loading;
  const { lines } = app.state;
  if (lines.length < 2 || !element.isConnected) return;
  const last = lines.at(-1)?.at ?? 0;
  const names = what === 'rates' ? Object.keys(lines.at(-1)?.rates ?? {}) : ['battery'];
  const data = [lines.map((line) => line.at - last), ...names.map((name) => lines.map((line) => (what === 'rates' ? (line.rates[name] ?? null) : line.battery)))];
  const width = element.clientWidth || 600;
  const before = plots.get(element);
  if (before !== undefined && before.width === width) {
    if (performance.now() - before.at > AGAIN_MS) {
      before.at = performance.now();
      before.plot.setData(data);
    }
    return;
  }
  before?.plot.destroy();
  const ink = getComputedStyle(element).color;
  const axis = { stroke: ink, grid: { stroke: '#88888833' }, ticks: { stroke: '#88888833' } };
  const series = [{ label: 's' }, ...names.map((label, index) => ({ label, stroke: COLOURS[index % 3], width: 2, dash: index === 0 ? [] : index === 1 ? [8, 4] : [2, 3] }))];
  const plot = new Plot({ width, height: 150, series, axes: [axis, { ...axis, size: 55 }], scales: { x: { time: false } }, cursor: { show: false }, legend: { live: false } }, data, element);
  plots.set(element, { plot, at: performance.now(), width });
}
