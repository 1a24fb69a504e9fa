// A client of robotd in plain JavaScript (Node 18 or later), without any package: it shows how little the wire asks for.
// It prints the status, then poses as they are published, then stops the robot and leaves when Ctrl-C is pressed.
//
//   node docs/examples/client.mjs [/run/robotd] [number of poses, then leave]
//
// ZeroMQ over a Unix socket is a greeting of 64 bytes, a READY command from either side, and frames with a length
// (ZMTP 3.0, https://rfc.zeromq.org/spec/23/). Messages are msgpack; `robotctl schema` describes every one.

import net from "node:net";
import process from "node:process";

const MORE = 1, LONG = 2, COMMAND = 4;

/** A ZeroMQ socket of one connection: `send(frame)`, and messages of one or more frames as an async iterator. */
class Socket {
  #waiting = [];
  #wake = () => {};

  constructor(path, type) {
    this.stream = net.connect(path);
    const greeting = Buffer.alloc(64);
    greeting.set([0xff, 0, 0, 0, 0, 0, 0, 0, 1, 0x7f, 3, 0]);
    greeting.write("NULL", 12, "ascii");
    this.stream.write(greeting);
    this.#command("READY", Buffer.concat([text8("Socket-Type"), length32(Buffer.from(type))]));
    this.#read();
  }

  send(frame) {
    const long = frame.length > 255;
    const head = Buffer.alloc(long ? 9 : 2);
    head[0] = long ? LONG : 0;
    if (long) head.writeBigUInt64BE(BigInt(frame.length), 1);
    else head[1] = frame.length;
    this.stream.write(Buffer.concat([head, frame]));
  }

  close() {
    this.stream.end();
  }

  async *[Symbol.asyncIterator]() {
    for (;;) {
      while (this.#waiting.length) yield this.#waiting.shift();
      if (this.ended) return;
      await new Promise((resolve) => (this.#wake = resolve));
    }
  }

  #command(name, body) {
    const frame = Buffer.concat([text8(name), body]);
    this.stream.write(Buffer.concat([Buffer.from([COMMAND, frame.length]), frame]));
  }

  async #read() {
    let bytes = Buffer.alloc(0), greeted = false, parts = [];
    try {
      for await (const chunk of this.stream) {
        bytes = Buffer.concat([bytes, chunk]);
        if (!greeted && bytes.length >= 64) [bytes, greeted] = [bytes.subarray(64), true];
        for (let frame; greeted && (frame = firstFrame(bytes)); bytes = bytes.subarray(frame.end)) {
          if (frame.flags & COMMAND) continue;
          parts.push(frame.body);
          if (frame.flags & MORE) continue;
          this.#waiting.push(parts);
          parts = [];
          this.#wake();
        }
      }
    } catch (error) {
      this.error = error;
    }
    this.ended = true;
    this.#wake();
  }
}

function firstFrame(bytes) {
  if (bytes.length < 2) return null;
  const long = bytes[0] & LONG;
  const start = long ? 9 : 2;
  if (bytes.length < start) return null;
  const end = start + (long ? Number(bytes.readBigUInt64BE(1)) : bytes[1]);
  return bytes.length < end ? null : { flags: bytes[0], body: bytes.subarray(start, end), end };
}

const text8 = (text) => Buffer.concat([Buffer.from([text.length]), Buffer.from(text)]);

function length32(bytes) {
  const head = Buffer.alloc(4);
  head.writeUInt32BE(bytes.length);
  return Buffer.concat([head, bytes]);
}

/** Return the msgpack of null, booleans, numbers, texts, arrays and plain objects. */
function pack(value) {
  if (value === null) return Buffer.from([0xc0]);
  if (typeof value === "boolean") return Buffer.from([value ? 0xc3 : 0xc2]);
  if (Number.isInteger(value) && value >= 0 && value < 128) return Buffer.from([value]);
  if (typeof value === "number") {
    const bytes = Buffer.alloc(9);
    bytes[0] = Number.isSafeInteger(value) ? 0xd3 : 0xcb;
    if (bytes[0] === 0xd3) bytes.writeBigInt64BE(BigInt(value), 1);
    else bytes.writeDoubleBE(value, 1);
    return bytes;
  }
  if (typeof value === "string") {
    const text = Buffer.from(value);
    return Buffer.concat([Buffer.from([0xdb]), length32(text)]);
  }
  const entries = Array.isArray(value) ? value.map(pack) : Object.entries(value).flat().map(pack);
  const head = Buffer.alloc(5);
  head[0] = Array.isArray(value) ? 0xdd : 0xdf;
  head.writeUInt32BE(Array.isArray(value) ? value.length : entries.length / 2, 1);
  return Buffer.concat([head, ...entries]);
}

/** Return the value of a msgpack message. */
function unpack(bytes) {
  let at = 0;
  const take = (count) => bytes.subarray(at, (at += count));
  const unsigned = (size) => Number(size === 8 ? take(8).readBigUInt64BE() : take(size).readUIntBE(0, size));
  const signed = (size) => Number(size === 8 ? take(8).readBigInt64BE() : take(size).readIntBE(0, size));
  const text = (length) => take(length).toString("utf8");
  const list = (length) => Array.from({ length }, next);
  const map = (length) => Object.fromEntries(Array.from({ length }, () => [next(), next()]));
  function next() {
    const kind = bytes[at++];
    if (kind < 0x80) return kind;
    if (kind < 0x90) return map(kind & 15);
    if (kind < 0xa0) return list(kind & 15);
    if (kind < 0xc0) return text(kind & 31);
    if (kind >= 0xe0) return kind - 256;
    if (kind >= 0xc4 && kind <= 0xc6) return Buffer.from(take(unsigned(1 << (kind - 0xc4))));
    if (kind >= 0xcc && kind <= 0xcf) return unsigned(1 << (kind - 0xcc));
    if (kind >= 0xd0 && kind <= 0xd3) return signed(1 << (kind - 0xd0));
    if (kind >= 0xd9 && kind <= 0xdb) return text(unsigned(1 << (kind - 0xd9)));
    if (kind === 0xdc || kind === 0xdd) return list(unsigned(kind === 0xdc ? 2 : 4));
    if (kind === 0xde || kind === 0xdf) return map(unsigned(kind === 0xde ? 2 : 4));
    if (kind === 0xca) return take(4).readFloatBE();
    if (kind === 0xcb) return take(8).readDoubleBE();
    return { 0xc0: null, 0xc2: false, 0xc3: true }[kind];
  }
  return next();
}

const [runtime = process.env.ROBOTD_RUNTIME_DIR ?? "/run/robotd", count = "Infinity"] = process.argv.slice(2);
const commands = new Socket(`${runtime}/commands.sock`, "DEALER");
const state = new Socket(`${runtime}/state.sock`, "SUB");

let lastId = 0;
const answers = commands[Symbol.asyncIterator]();
async function ask(cmd, args = {}) {
  const id = ++lastId;
  commands.send(pack({ v: 1, id, cmd, args }));
  for (;;) {
    const { value: frames, done } = await answers.next();
    if (done) throw commands.error ?? new Error("the daemon hung up");
    const reply = unpack(frames.at(-1));
    if (reply.id !== id) continue;
    if (!reply.ok) throw new Error(`${reply.error.code}: ${reply.error.message}`);
    return reply.result;
  }
}

process.once("SIGINT", async () => {
  await ask("stop", { reason: "Ctrl-C in the example" });
  commands.close();
  state.close();
});

const status = await ask("status");
console.log(`mode ${status.mode}: ${status.reason}`);
state.send(Buffer.concat([Buffer.from([1]), Buffer.from("pose\0")])); // 1 subscribes, 0 takes it back
let seen = 0;
for await (const [frame] of state) {
  const pose = unpack(frame.subarray(frame.indexOf(0) + 1));
  const where = pose.best ? `x ${pose.best.x_m.toFixed(3)} m, y ${pose.best.y_m.toFixed(3)} m` : `${pose.regions.length} places`;
  console.log(`${pose.state}: ${where}, ${pose.best_rank} of ${pose.readings} readings explained`);
  if (++seen >= Number(count)) break;
}
commands.close();
state.close();
