// Numbers and times as people read them.

/** @param {number} metres */
export const metres = (metres) => (Math.abs(metres) < 1 && metres !== 0 ? `${Math.round(metres * 100)} cm` : `${metres.toFixed(2)} m`);
/** @param {number} value */
export const place = (value) => value.toFixed(2);
/** @param {number} rad */
export const degrees = (rad) => `${Math.round((rad * 180) / Math.PI)}°`;
/** @param {number} seconds */
export function age(seconds) {
  if (!Number.isFinite(seconds)) return 'a while';
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (seconds < 100) return `${Math.round(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${Math.round(seconds / 3600)} h`;
}
/** @param {number} bytes */
export function size(bytes) {
  const units = ['B', 'KiB', 'MiB', 'GiB'];
  let unit = 0;
  for (; bytes >= 1024 && unit < 3; unit++) bytes /= 1024;
  return `${unit === 0 ? bytes : bytes.toFixed(1)} ${units[unit]}`;
}
/** @param {number} unixSeconds */
export const when = (unixSeconds) => new Date(unixSeconds * 1000).toLocaleString('en-GB', { dateStyle: 'medium', timeStyle: 'short' });
/** @param {number} unixSeconds */
export const clock = (unixSeconds) => new Date(unixSeconds * 1000).toLocaleTimeString('en-GB', { hour12: false });
