// How it looks: dark by default; light and high contrast by wish.

export const THEMES = /** @type {const} */ (['dark', 'light', 'contrast']);
const KEY = 'robotd.theme';

export function theme() {
  return localStorage.getItem(KEY) ?? (matchMedia('(prefers-contrast: more)').matches ? 'contrast' : 'dark');
}

/** @param {string} name */
export function applyTheme(name) {
  document.documentElement.dataset['theme'] = name;
}

/** @param {string} name @param {import('../app.js').App} app */
export function chooseTheme(name, app) {
  localStorage.setItem(KEY, name);
  applyTheme(name);
  app.canvas?.recolour();
  app.wake(true);
}
