// The daemon's frames: one byte of kind, the topic, a zero byte, and a msgpack map.
import { decode } from '@msgpack/msgpack';

/** @typedef {import('../types').Frame} Frame */

const FRAME = 1;
const VERSION = 1;
const text = new TextDecoder();

/**
 * Return what a binary message says; null if it is of a kind or a version that this page does not know.
 * @param {ArrayBuffer} data
 * @returns {Frame | null}
 */
export function readFrame(data) {
  const bytes = new Uint8Array(data);
  const end = bytes.indexOf(0, 1);
  if (bytes[0] !== FRAME || end < 0) return null;
  let fields;
  try {
    fields = /** @type {any} */ (decode(bytes.subarray(end + 1)));
  } catch {
    return null;
  }
  if (typeof fields !== 'object' || fields === null || fields.v !== VERSION) return null;
  return { topic: text.decode(bytes.subarray(1, end)), event: fields.event, session: fields.session, seq: fields.seq, fields };
}
