// Recordings: one under way, those that can be fetched, and what is made of them.
import { html, nothing } from 'lit-html';
import { size, when } from '../parts/format.js';
import { typedForm } from '../parts/typed.js';
import { t } from '../texts/texts.js';

/** @typedef {import('../app.js').App} App */

const AGAIN_MS = 5000;
/** What the gateway makes of a recording: the ending of its address, and the text of its button. */
const FORMS = /** @type {const} */ ([['.html', 'rec.report'], ['.foxglove.mcap', 'rec.foxglove'], ['.bag.zip', 'rec.bag']]);
/** @type {{ name: string, bytes: number, changed_unix_s: number }[] | null} */
let found = null;
let askedAt = -Infinity;
/** What is being made. */
let making = '';
/** A recording that is to be deleted, and what is typed below it. @type {{ name: string, typed: string } | null} */
let deletion = null;

/** @param {App} app */
export function recordingsPage(app) {
  if (performance.now() - askedAt > AGAIN_MS) {
    askedAt = performance.now();
    app.fetch('api/recordings').then((answer) => { found = answer.recordings; app.wake(); }, () => {});
  }
  const { status, hello } = app.state;
  const may = hello !== null && hello.role !== 'viewer';
  const under = status?.recording ?? null;
  return html`<h1>${t('rec.title')}</h1>
    <section class="card"><p>${under === null ? t('rec.not') : t('rec.running', { path: under })}</p>
      ${may ? html`<button @click=${() => { askedAt = -Infinity; app.command(under === null ? 'record_start' : 'record_stop'); }}>${under === null ? t('rec.start') : t('rec.stop')}</button>` : nothing}</section>
    <p class="quiet" role="status">${making === '' ? '' : t('rec.making', { name: making })}</p>
    ${found === null || found.length === 0 ? html`<section class="card"><p class="quiet">${t('rec.none')}</p></section>`
      : html`<div class="cards">${found.map((file) => card(app, file, under?.endsWith(`/${file.name}`) ?? false))}</div>`}`;
}

/** @param {App} app @param {{ name: string, bytes: number, changed_unix_s: number }} file @param {boolean} isUnderWay */
function card(app, file, isUnderWay) {
  const { name } = file;
  const path = `api/recordings/${name}`;
  const mayDelete = app.state.hello?.role === 'admin' && !isUnderWay;
  return html`<article class="card" aria-label=${name}><h2 class="name">${name}${isUnderWay ? html` <span class="tag">${t('rec.now')}</span>` : nothing}</h2>
    <p class="quiet"><span class="value">${size(file.bytes)}</span><br>${t('rec.changed', { when: when(file.changed_unix_s) })}</p>
    <div class="buttons"><a class="button" href=${path} download=${name}>${t('rec.download')}</a>
      ${FORMS.map(([ending, text]) => html`<button aria-disabled=${making !== ''} @click=${() => making === '' && make(app, `${path}${ending}`, name)}>${t(text)}</button>`)}
      ${mayDelete && deletion?.name !== name ? html`<button class="danger" @click=${() => { deletion = { name, typed: '' }; app.wake(true); }}>${t('maps.delete')}</button>` : nothing}</div>
    ${mayDelete && deletion?.name === name ? deleting(app, deletion) : nothing}</article>`;
}

/** @param {App} app @param {{ name: string, typed: string }} wanted */
function deleting(app, wanted) {
  const end = () => { deletion = null; app.wake(true); };
  return typedForm({
    label: t('maps.delete_sure', { name: wanted.name }), verb: t('maps.delete'), typed: wanted.typed, isRight: wanted.typed === wanted.name, isDangerous: true, end,
    type: (typed) => { wanted.typed = typed; app.wake(true); },
    act: async () => {
      if ((await app.command('record_delete', { path: wanted.name })) === undefined) return;
      askedAt = -Infinity;
      end();
    },
  });
}

/** Let the gateway make a file, which takes a while and may be refused, and only then fetch it. @param {App} app @param {string} path @param {string} name */
async function make(app, path, name) {
  making = name;
  app.wake(true);
  try {
    const answer = await fetch(path, { headers: { Range: 'bytes=0-0' } });
    if (!answer.ok) throw new Error((await answer.json()).message);
    Object.assign(document.createElement('a'), { href: path, download: '' }).click();
  } catch (error) {
    app.notice('refused', t('refused', { message: error instanceof Error ? error.message : String(error) }));
  }
  making = '';
  app.wake(true);
}
