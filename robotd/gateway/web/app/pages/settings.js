// Settings: how the page looks, who is signed in, what the robot goes by, and who may come in.
import { html, nothing } from 'lit-html';
import { when } from '../parts/format.js';
import { foxgloveCard } from '../parts/foxglove.js';
import { signOut } from '../parts/sign-in.js';
import { chooseTheme, theme, THEMES } from '../parts/theme.js';
import { t } from '../texts/texts.js';

/** @typedef {import('../app.js').App} App */

let config = '';
let licences = '';
/** @type {any} */
let access = null;
let asked = '';

/** @param {App} app */
export function settingsPage(app) {
  const { hello, session } = app.state;
  if (hello !== null && asked !== `${session}`) {
    asked = `${session}`;
    ask(app);
  }
  return html`<h1>${t('set.title')}</h1>
    <div class="cards">
      <section class="card"><h2>${t('set.look')}</h2><div class="buttons" role="group" aria-label=${t('set.theme')}>${THEMES.map((name) => html`<button aria-pressed=${theme() === name} @click=${() => chooseTheme(name, app)}>${t(`set.${name}`)}</button>`)}</div></section>
      <section class="card"><h2>${t('set.you')}</h2><p>${t('set.you_are', { name: app.who?.name ?? '', role: t(`role.${app.who?.role}`) })}</p><button @click=${() => signOut(app)}>${t('sign.out')}</button></section>
      <section class="card"><h2>${t('set.versions')}</h2><p>${hello === null ? nothing : t('set.gateway', { version: hello.gateway, console: hello.console })}</p><p class="quiet">${t('set.daemon', { session: session ?? '…' })}</p></section>
      <section class="card"><h2>${t('set.keys')}</h2><p>${t('set.keys_text')}</p></section>
      ${foxgloveCard(app)}
    </div>
    ${access === null ? nothing : comers()}
    <section class="card"><details><summary>${t('set.config')}</summary><pre tabindex="0">${config}</pre></details></section>
    <section class="card"><details @toggle=${() => load(app)}><summary>${t('set.licences')}</summary><pre tabindex="0">${licences}</pre></details></section>`;
}

/** @param {App} app */
async function ask(app) {
  config = (await app.link.ask('command', { cmd: 'config' }).catch(() => ({ text: '' }))).text;
  access = app.who?.role === 'admin' ? await app.fetch('api/access').catch(() => null) : null;
  app.wake(true);
}

/** @param {App} app */
async function load(app) {
  if (licences !== '') return;
  licences = await fetch('app/licences.txt').then((answer) => answer.text(), () => '');
  app.wake(true);
}

function comers() {
  return html`<section class="card table-scroll"><h2>${t('set.access')}</h2>
    <table><caption>${t('set.tokens')}</caption><thead><tr><th scope="col">${t('set.name')}</th><th scope="col">${t('set.role')}</th><th scope="col">${t('set.until')}</th></tr></thead>
      <tbody>${access.tokens.map((/** @type {any} */ token) => html`<tr><td>${token.name}</td><td>${token.role}</td><td>${token.is_used_up ? t('set.used_up') : token.expires_unix_s === null ? t('set.forever') : when(token.expires_unix_s)}</td></tr>`)}</tbody></table>
    <table><caption>${t('set.sessions')}</caption><thead><tr><th scope="col">${t('set.name')}</th><th scope="col">${t('set.role')}</th><th scope="col">${t('set.seen')}</th><th scope="col">${t('set.pages')}</th></tr></thead>
      <tbody>${access.sessions.map((/** @type {any} */ session) => html`<tr><td>${session.name}</td><td>${session.role}</td><td>${session.ended_unix_s === null ? when(session.seen_unix_s) : t('set.ended')}</td><td>${session.pages}</td></tr>`)}</tbody></table></section>`;
}
