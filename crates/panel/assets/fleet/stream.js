// The server's events, connected again whenever the connection breaks or falls silent.

/** Between two looks, ms. */
const LOOK_MS = 500;
/** The server gives a sign of life every second: after this long without one nothing that is shown holds, ms. */
export const SILENCE_MS = 3000;
/** After this long without one the connection is tried anew, ms. */
const DEAD_MS = 6000;
/** Before a server that refused is asked again, ms. */
const AGAIN_MS = 2000;

/**
 * @typedef {object} Handlers
 * @property {(wall: import("./messages").Wall) => void} wall
 * @property {(news: import("./messages").News) => void} news
 * @property {(alive: import("./messages").Alive) => void} alive
 * @property {(heard: boolean) => void} heard
 * @property {() => void} refused the connection was not accepted: perhaps a token is missing
 */

/**
 * Listens for ever.
 * @param {Handlers} handlers
 */
export function listen(handlers) {
  let heard = performance.now();
  let source = open();

  function open() {
    const source = new EventSource("/api/fleet/stream");
    /**
     * @template T
     * @param {string} name
     * @param {(message: T) => void} take
     */
    const on = (name, take) => source.addEventListener(name, (event) => {
      heard = performance.now();
      take(JSON.parse(event.data));
    });
    on("wall", handlers.wall);
    on("news", handlers.news);
    on("alive", handlers.alive);
    source.onerror = () => {
      // The browser itself tries again after a broken connection, not after a refusal.
      if (source.readyState === EventSource.CLOSED) handlers.refused();
    };
    return source;
  }

  let tried = performance.now();
  setInterval(() => {
    const now = performance.now();
    handlers.heard(now - heard <= SILENCE_MS);
    const closed = source.readyState === EventSource.CLOSED && now - tried > AGAIN_MS;
    if (!closed && now - Math.max(heard, tried) < DEAD_MS) return;
    source.close();
    source = open();
    tried = now;
  }, LOOK_MS);
}
