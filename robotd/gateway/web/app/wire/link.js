// The socket to the gateway: opened again whenever it is lost; questions answered; nothing queued or repeated.
import { waitMs } from './backoff.js';
import { readFrame } from './decode.js';

/** @typedef {{ code: string, message: string }} Problem */

const ANSWER_WITHIN_MS = 65_000;
/** A socket on which nothing comes for so long is dead, whatever it says of itself. */
const DEAD_MS = 3000;
const LOOK_MS = 500;

/** What went wrong, in the gateway's words. */
export class Refused extends Error {
  /** @param {Problem} problem */
  constructor(problem) {
    super(problem.message);
    this.code = problem.code;
  }
}

export class Link {
  /** @type {WebSocket | null} */
  #socket = null;
  /** @type {Map<number, { resolve: (value: any) => void, reject: (error: Error) => void, timer: number }>} */
  #waiting = new Map();
  #number = 0;
  #failed = 0;
  #timer = 0;
  #heardAt = 0;
  #lookedAt = 0;

  /**
   * @param {{ frame: (frame: import('../types').Frame) => void, text: (said: any) => void,
   *   opened: () => void, closed: (code: number) => void }} to who is told
   */
  constructor(to) {
    this.to = to;
    addEventListener('online', () => this.#now());
    document.addEventListener('visibilitychange', () => document.hidden || this.#now());
    setInterval(() => this.#look(), LOOK_MS);
  }

  get isOpen() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  open() {
    clearTimeout(this.#timer);
    const address = new URL('api/ws', document.baseURI);
    address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(address, 'robotd.console.v1');
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    this.#heardAt = performance.now();
    socket.onopen = () => this.to.opened();
    socket.onmessage = (event) => this.#take(event.data);
    socket.onclose = (event) => this.#lost(socket, event.code);
  }

  /**
   * Send a request and return its answer.
   * @param {string} type
   * @param {Record<string, unknown>} fields
   * @returns {Promise<any>}
   */
  ask(type, fields = {}) {
    if (!this.isOpen) return Promise.reject(new Refused({ code: 'no_gateway', message: 'nothing was sent: the gateway is not reached' }));
    const id = ++this.#number;
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => this.#settle(id, unknown()), ANSWER_WITHIN_MS);
      this.#waiting.set(id, { resolve, reject, timer });
      this.#socket?.send(JSON.stringify({ type, id, ...fields }));
    });
  }

  /** Send a text if there is somebody to send it to. @param {Record<string, unknown>} said */
  say(said) {
    if (this.isOpen) this.#socket?.send(JSON.stringify(said));
    return this.isOpen;
  }

  close() {
    clearTimeout(this.#timer);
    const socket = this.#socket;
    this.#socket = null;
    socket?.close();
  }

  /** @param {ArrayBuffer | string} data */
  #take(data) {
    this.#heardAt = performance.now();
    if (typeof data !== 'string') {
      const frame = readFrame(data);
      if (frame !== null) this.to.frame(frame);
      return;
    }
    const said = JSON.parse(data);
    // Answered here, by the page's main thread, which is what is asked after.
    if (said.type === 'question') this.say({ type: 'answer', n: said.n });
    if (said.type === 'hello') this.#failed = 0;
    if (said.type === 'result') this.#settle(said.id, null, said.result);
    else if (said.type === 'problem' && this.#waiting.has(said.id)) this.#settle(said.id, new Refused(said));
    else this.to.text(said);
  }

  /** @param {number} id @param {Error | null} error @param {any} [value] */
  #settle(id, error, value) {
    const waiting = this.#waiting.get(id);
    if (waiting === undefined) return;
    this.#waiting.delete(id);
    clearTimeout(waiting.timer);
    if (error === null) waiting.resolve(value);
    else waiting.reject(error);
  }

  /** @param {WebSocket} socket @param {number} code */
  #lost(socket, code) {
    if (socket !== this.#socket) return;
    this.#socket = null;
    // What was asked may have been carried out: nobody asks again by himself.
    for (const id of [...this.#waiting.keys()]) this.#settle(id, unknown());
    this.to.closed(code);
    this.#timer = setTimeout(() => this.open(), waitMs(this.#failed++, Math.random()));
  }

  #look() {
    const socket = this.#socket, now = performance.now();
    // If this page itself stood still, what came meanwhile has not been taken yet: the socket is not to blame.
    const stoodStill = now - this.#lookedAt > 2 * LOOK_MS;
    this.#lookedAt = now;
    if (socket !== null && !stoodStill && now - this.#heardAt > DEAD_MS) {
      socket.close();
      this.#lost(socket, 1006);
    }
  }

  #now() {
    if (this.#socket === null && this.#timer !== 0) {
      this.#failed = 0;
      this.open();
    }
  }
}

function unknown() {
  return new Refused({ code: 'outcome_unknown', message: 'no answer came: look whether it was carried out' });
}
