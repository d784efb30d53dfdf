// How old what is shown may be: data that no longer come must not look healthy.

/** After this long without a window, or without any word from the server, nothing that is shown holds any more, ms. */
export const LIMIT_MS = 2000;
/** Below this speed a source may rightly take longer than the limit for one window: the limit grows in proportion. */
const SLOW = 0.1;

/**
 * @typedef {object} Heard
 * @property {number} window when the last window came, ms
 * @property {number} word when the last message of any kind came, ms
 * @property {boolean} rests the source is paused or has ended: no window is due
 * @property {number} speed source seconds per second on the wall
 */

/**
 * Whether what is shown is too old; all times on one clock.
 * @param {Heard} heard
 * @param {number} now ms
 * @returns {boolean}
 */
export function stale({ window, word, rests, speed }, now) {
  if (now - word > LIMIT_MS) return true;
  const limit = LIMIT_MS * Math.max(1, SLOW / Math.max(speed, 1e-3));
  return !rests && now - window > limit;
}

/** Keeps the times; `now` is the page's rising clock, which a clock that was set does not move. */
export class Watch {
  /** @param {() => number} now */
  constructor(now = () => performance.now()) {
    this.now = now;
    /** @type {Heard} */
    this.heard = { window: now(), word: now(), rests: false, speed: 1 };
    this.since = new Date();
  }

  /** A window has come, or a word that none is due. */
  window() {
    this.heard.window = this.heard.word = this.now();
    this.since = new Date();
  }

  /**
   * The server lives.
   * @param {boolean} rests
   */
  alive(rests) {
    this.heard.word = this.now();
    // What rests was shown rightly until now, and its next window is due from now on.
    if (rests || this.heard.rests) this.window();
    this.heard.rests = rests;
  }

  /** @returns {boolean} */
  stale() {
    return stale(this.heard, this.now());
  }
}
