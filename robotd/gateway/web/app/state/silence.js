// Whether what is shown is true now: age decides, not whether a socket is open. Pure.

/** @typedef {import('../types').State} State */

const STATUS_MS = 2500;
const ODOMETRY_MS = 1000;
const GATEWAY_MS = 1500;

/**
 * Return who is silent, and for how long [s]; null if all that is shown is fresh.
 * @param {State} state @param {number} now
 * @returns {{ part: 'page' | 'gateway' | 'daemon' | 'base', seconds: number } | null}
 */
export function silent(state, now) {
  if (state.hello === null) return null;
  const since = Math.max(state.statusAt, -1e12);
  const gateway = now - state.questionAt;
  if (!state.isOpen || gateway > GATEWAY_MS) return { part: state.isOpen ? 'gateway' : 'page', seconds: gateway / 1000 };
  if (state.status === null) {
    return state.daemonSilent !== null && state.daemonSilent < STATUS_MS / 1000 ? null : { part: 'daemon', seconds: Math.max(0, state.daemonSilent ?? NaN) };
  }
  if (now - since > STATUS_MS) return { part: 'daemon', seconds: (now - since) / 1000 };
  const drive = state.status.devices.find((device) => device.name === 'drive');
  const odometry = now - state.odometryAt;
  if (drive?.armed && odometry > ODOMETRY_MS) return { part: 'base', seconds: odometry / 1000 };
  return null;
}

/**
 * Return why an act cannot be done now, and what helps; null if it can be.
 * @param {State} state @param {'arm' | 'drive' | 'clear' | 'command'} act @param {number} now
 * @returns {{ why: string, remedy: string } | null}
 */
export function hindrance(state, act, now) {
  const silence = silent(state, now);
  if (silence !== null || state.hello === null || state.status === null) return { why: 'silent', remedy: 'silent' };
  if (state.hello.role === 'viewer') return { why: 'viewer', remedy: 'viewer' };
  const mode = state.status.mode;
  if (act === 'clear') return mode === 'fault' ? null : { why: 'no_fault', remedy: 'none' };
  if (mode === 'fault') return { why: 'fault', remedy: 'clear' };
  if (act === 'arm') {
    if (mode !== 'disarmed') return { why: 'armed', remedy: 'none' };
    const absent = state.status.devices.filter((device) => device.link !== 'ready');
    return absent.length === state.status.devices.length ? { why: 'no_device', remedy: 'plug' } : null;
  }
  if (act === 'drive') {
    if (mode === 'disarmed') return { why: 'disarmed', remedy: 'arm' };
    if (state.status.mission_id !== null) return { why: 'busy', remedy: 'stop' };
  }
  return null;
}
