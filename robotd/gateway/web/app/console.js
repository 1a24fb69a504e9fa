// The console: sign in, listen, draw.
import { App } from './app.js';
import { bindKeys } from './keys.js';
import { page } from './parts/frame.js';
import { signInFromAddress } from './parts/sign-in.js';
import { guardStop, raiseStop } from './parts/stop-place.js';
import { applyTheme, theme } from './parts/theme.js';

const TICK_MS = 250;

applyTheme(theme());
const root = /** @type {HTMLElement} */ (document.getElementById('root'));
const app = new App(root, page, raiseStop);
// For whoever looks at the page from its own tools.
Object.assign(globalThis, { robotd: app });

addEventListener('hashchange', () => open_());
document.addEventListener('visibilitychange', () => watchHidden());
bindKeys(app);
guardStop(app);
setInterval(() => app.wake(), TICK_MS); // ages grow though nothing comes
start();

async function start() {
  await signInFromAddress(app);
  open_();
  // Not one after the other: a page on a slow network shows its robot a round trip sooner. Who is not signed in gets no socket.
  app.link.open();
  app.who ??= await app.fetch('api/session').catch(() => null);
  if (app.who === null) app.link.close();
  else document.title = app.who.robot;
  app.wake(true);
}

function open_() {
  const name = /^#\/(\w+)$/.exec(location.hash)?.[1];
  if (name !== undefined) app.page = name;
  app.isMenuOpen = false;
  app.wake(true);
}

let hiddenAt = 0;
/** @type {any} */
let awake = null;

async function watchHidden() {
  if (document.hidden) {
    hiddenAt = performance.now();
    return;
  }
  const { commander, hello } = app.state;
  if (commander !== null && commander.driver.browser === hello?.browser && commander.attended) app.hiddenFor = (performance.now() - hiddenAt) / 1000;
  app.wake(true);
}

/** A phone that drives keeps its screen on. */
setInterval(async () => {
  const { commander, hello } = app.state;
  const isDriving = commander !== null && commander.driver.browser === hello?.browser;
  if (isDriving && awake === null && !document.hidden) {
    awake = await navigator.wakeLock?.request('screen').catch(() => null);
    awake?.addEventListener('release', () => (awake = null));
  } else if (!isDriving && awake !== null) await awake.release();
}, 1000);
