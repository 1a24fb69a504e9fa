// Signing in: by the token behind `#` of the address, which no server's log sees, or by typing it.
import { html } from 'lit-html';
import { t } from '../texts/texts.js';

/** @typedef {import('../app.js').App} App */

const TOKEN = /^#[\w-]{20,}$/;

/** @param {App} app */
export async function signInFromAddress(app) {
  if (!TOKEN.test(location.hash)) return;
  const token = location.hash.slice(1);
  history.replaceState(null, '', location.pathname + location.search);
  await signIn(app, token);
}

/** @param {App} app @param {string} token */
async function signIn(app, token) {
  try {
    await app.fetch('api/session', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify({ token }) });
    app.who = await app.fetch('api/session');
    app.notices = [];
  } catch (error) {
    app.notice('refused', t('sign.wrong', { message: error instanceof Error ? error.message : '' }));
  }
}

/** @param {App} app */
export function signInPage(app) {
  /** @param {SubmitEvent} event */
  const submit = async (event) => {
    event.preventDefault();
    const form = /** @type {HTMLFormElement} */ (event.currentTarget);
    const typed = String(new FormData(form).get('token')).trim();
    await signIn(app, typed.slice(typed.indexOf('#') + 1));
    if (app.who !== null) app.link.open();
    app.wake(true);
  };
  return html`<main class="sign-in">
    <h1>robotd</h1>
    <form class="card" @submit=${submit}>
      <label for="token">${t('sign.token')}</label>
      <input id="token" name="token" type="password" autocomplete="current-password" required>
      <button class="primary">${t('sign.enter')}</button>
      <p class="quiet">${t('sign.how')}</p>
    </form>
  </main>`;
}

/** @param {App} app */
export async function signOut(app) {
  await app.fetch('api/session', { method: 'DELETE' }).catch(() => {});
  app.link.close();
  location.reload();
}
