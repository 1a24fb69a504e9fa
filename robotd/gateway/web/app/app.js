// What the parts of the page share: the state, the socket, what can be asked, and the drawing of the page.
import { render } from 'lit-html';
import { Grid } from './map/grid.js';
import { alarm, Stopping } from './parts/stopping.js';
import { rankOverlay } from './map/overlays.js';
import { accept, hear, nothing } from './state/store.js';
import { Link, Refused } from './wire/link.js';
import { t } from './texts/texts.js';

/** The panel is drawn no more often than this: people do not read faster. */
const DRAW_MS = 150;
/** What comes often and is drawn nowhere on the map. */
const BESIDE_MAP = new Set(['odometry', 'log', 'range_measured', 'sweep_progress']);

export class App {
  state = nothing();
  grid = new Grid();
  /** Who is signed in; null while nobody is. @type {{ name: string, role: string, robot: string } | null} */
  who = null;
  page = 'drive';
  robotRadius = 0.3;
  isMenuOpen = false;
  /** What is said about what was asked, the latest last. @type {{ id: number, kind: 'done' | 'refused' | 'news', text: string }[]} */
  notices = [];
  hiddenFor = 0;
  #number = 0;
  #drawn = 0;
  #wanted = false;

  /** @param {HTMLElement} root @param {(app: App) => unknown} page draws all of it @param {() => void} drawn is told when that is on the page */
  constructor(root, page, drawn) {
    this.drawn = drawn;
    this.root = root;
    this.draw = page;
    this.stopping = new Stopping({
      say: (said) => this.link.say(said),
      post: () => fetch('api/stop', { method: 'POST', keepalive: true }).then((answer) => answer.ok),
      changed: () => this.wake(true),
      alarm,
    });
    this.link = new Link({
      frame: (frame) => this.#frame(frame),
      text: (said) => this.#text(said),
      opened: () => this.#set({ isOpen: true }),
      closed: () => this.#closed(),
    });
    /** @type {import('./map/canvas.js').MapCanvas | null} */
    this.canvas = null;
  }

  /** Draw the page and the map soon. */
  wake(isUrgent = false) {
    this.canvas?.wake();
    this.#wakePage(isUrgent);
  }

  #wakePage(isUrgent = false) {
    if (this.#wanted && !isUrgent) return;
    this.#wanted = true;
    const wait = isUrgent ? 0 : Math.max(0, DRAW_MS - (performance.now() - this.#drawn));
    setTimeout(() => {
      this.#wanted = false;
      this.#drawn = performance.now();
      render(/** @type {any} */ (this.draw(this)), this.root);
      this.drawn();
    }, wait);
  }

  /** Send a command; what is refused is shown word for word. @param {string} cmd @param {Record<string, unknown>} [args] @param {string} [done] */
  command(cmd, args = {}, done = t('done')) {
    return this.#asked(this.link.ask('command', { cmd, args }), done);
  }

  /** Start a mission. @param {string} cmd @param {Record<string, unknown>} args @param {boolean} attended */
  mission(cmd, args, attended) {
    return this.#asked(this.link.ask('mission', { cmd, args, attended }), '');
  }

  /** @param {string} type @param {Record<string, unknown>} [fields] */
  ask(type, fields = {}) {
    return this.#asked(this.link.ask(type, fields), '');
  }

  /** Ask by HTTP. @param {string} path @param {RequestInit} [how] @returns {Promise<any>} */
  async fetch(path, how = {}) {
    const answer = await fetch(path, how);
    const body = answer.status === 204 ? {} : await answer.json();
    if (!answer.ok) throw new Refused(body);
    return body;
  }

  /** @param {'done' | 'refused' | 'news'} kind @param {string} text */
  notice(kind, text) {
    if (text === '') return;
    const id = ++this.#number;
    this.notices = [...this.notices.slice(-3), { id, kind, text }];
    setTimeout(() => this.dismiss(id), kind === 'refused' ? 20_000 : 5000);
    this.wake(true);
  }

  /** @param {number} id */
  dismiss(id) {
    this.notices = this.notices.filter((notice) => notice.id !== id);
    this.wake();
  }

  /** Return what came of it, or undefined: it was refused, which is shown. @param {Promise<any>} answer @param {string} done */
  async #asked(answer, done) {
    try {
      const result = await answer;
      this.notice('done', done);
      return result ?? {};
    } catch (error) {
      const code = error instanceof Refused ? error.code : '';
      this.notice('refused', t(code === 'outcome_unknown' ? 'outcome_unknown' : 'refused', { message: error instanceof Error ? error.message : String(error) }));
      return undefined;
    } finally {
      this.wake(true);
    }
  }

  /** Ask for the layers that the daemon makes only while somebody looks at them. */
  look() {
    this.link.say({ type: 'look', rank: this.canvas?.shown.has('rank') ?? false });
  }

  /** What a page asks for itself when it is greeted. */
  async #begin() {
    this.look();
    const config = await this.link.ask('command', { cmd: 'config' }).catch(() => null);
    const radius = Number(/^robot_radius_m = ([\d.]+)$/m.exec(config?.text ?? '')?.[1]);
    if (radius > 0) this.robotRadius = radius;
    this.wake();
  }

  /** @param {import('./types').Frame} frame */
  #frame(frame) {
    if (frame.session !== this.state.session) this.grid.forget();
    accept(this.state, frame, performance.now());
    if (frame.event === 'rank_map') rankOverlay(frame.fields).then((rank) => { if (this.canvas !== null) this.canvas.rank = rank; this.wake(); }, () => {});
    if (frame.event === 'map_changed') this.grid.accept(frame.fields).then(() => this.wake());
    if (BESIDE_MAP.has(frame.event)) this.#wakePage();
    else this.wake();
  }

  /** @param {any} said */
  #text(said) {
    if (said.type === 'stopped') this.stopping.confirmed();
    else if (said.type === 'problem') this.notice('refused', t('refused', { message: said.message }));
    else hear(this.state, said, performance.now());
    if (said.type === 'hello') this.#begin();
    if (said.type !== 'question') this.#wakePage();
  }

  /** @param {Partial<import('./types').State>} changes */
  #set(changes) {
    Object.assign(this.state, changes);
    this.wake();
  }

  async #closed() {
    this.#set({ isOpen: false });
    // A session that has ended cannot open a socket: then this page asks for a token instead of trying for ever.
    const answer = await fetch('api/session').catch(() => null);
    if (answer?.status === 401 && this.who !== null) {
      this.link.close();
      this.who = null;
      this.notice('refused', t('sign.ended'));
    }
  }
}
