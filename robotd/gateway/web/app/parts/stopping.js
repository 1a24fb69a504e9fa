// STOP: sent at once by socket and by POST, again each 100 ms, until it is confirmed or 3 s are over.
import { t } from '../texts/texts.js';

const AGAIN_MS = 100;
const WARN_MS = 300;
const GIVEN_UP_MS = 3000;
const SHOWN_MS = 8000;

/** @typedef {'ready' | 'stopping' | 'stopped' | 'unconfirmed'} Phase */

export class Stopping {
  /** @type {Phase} */
  phase = 'ready';
  tookMs = 0;
  #begun = 0;
  #timer = 0;
  #rest = 0;

  /**
   * @param {{ say: (said: Record<string, unknown>) => boolean, post: () => Promise<boolean>, changed: () => void, alarm: () => void }} ways
   */
  constructor(ways) {
    this.ways = ways;
  }

  /** What the button says. */
  get label() {
    return { ready: t('stop.ready'), stopping: t('stop.stopping'), stopped: t('stop.stopped', { ms: Math.round(this.tookMs) }), unconfirmed: t('stop.unconfirmed_short') }[this.phase];
  }

  press() {
    clearTimeout(this.#rest);
    if (this.phase !== 'stopping') { // of a key that is held, each press but the first comes while it stops
      this.#begun = performance.now();
      if (this.phase !== 'unconfirmed') this.phase = 'stopping';
      clearInterval(this.#timer);
      this.#timer = setInterval(() => this.#again(), AGAIN_MS);
    }
    this.#send();
    this.ways.changed();
  }

  /** The daemon has confirmed a stop. */
  confirmed() {
    if (this.phase === 'ready' || this.phase === 'stopped') return;
    this.tookMs = performance.now() - this.#begun;
    this.#end('stopped');
  }

  #send() {
    this.ways.say({ type: 'stop', id: 0 });
    this.ways.post().then((isConfirmed) => isConfirmed && this.confirmed(), () => {});
  }

  #again() {
    const since = performance.now() - this.#begun;
    if (since >= WARN_MS && this.phase === 'stopping') {
      this.phase = 'unconfirmed';
      this.ways.alarm();
      this.ways.changed();
    }
    if (since >= GIVEN_UP_MS) clearInterval(this.#timer);
    else this.#send();
  }

  /** @param {Phase} phase */
  #end(phase) {
    clearInterval(this.#timer);
    this.phase = phase;
    this.#rest = setTimeout(() => {
      this.phase = 'ready';
      this.ways.changed();
    }, SHOWN_MS);
    this.ways.changed();
  }
}

/** Sound and vibration: whoever looks elsewhere must notice. */
export function alarm() {
  navigator.vibrate?.([300, 100, 300, 100, 300]);
  try {
    const audio = new AudioContext();
    const tone = audio.createOscillator();
    tone.frequency.value = 880;
    tone.connect(audio.destination);
    tone.start();
    tone.stop(audio.currentTime + 0.8);
    tone.onended = () => audio.close();
  } catch {
    // No sound here: the banner is there.
  }
}
