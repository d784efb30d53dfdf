// The server's events, connected again whenever the connection breaks or falls silent.

/** After the browser has given up it is tried again, ms. */
const AGAIN_MS = 1000;
/** The server gives a sign of life twice a second: after this long without one the connection is dead, ms. */
const SILENCE_MS = 4000;

/**
 * @typedef {object} Handlers
 * @property {(state: "open" | "waiting") => void} connection
 * @property {(status: import("./messages").Status) => void} status
 * @property {(window: import("./messages").WindowMessage) => void} window
 * @property {(wave: import("./messages").WaveMessage) => void} wave
 * @property {(events: import("./messages").EventMessage[]) => void} events
 * @property {(alive: import("./messages").Alive) => void} alive
 * @property {(messages: number) => void} lost
 */

/**
 * Listens for ever.
 * @param {Handlers} handlers
 */
export function listen(handlers) {
  const source = new EventSource("/api/stream");
  let heard = performance.now();
  const again = () => {
    clearInterval(watch);
    source.close();
    listen(handlers);
  };
  // A cable that was pulled does not end the connection: the page must notice it itself.
  const watch = setInterval(() => {
    if (performance.now() - heard < SILENCE_MS) return;
    handlers.connection("waiting");
    again();
  }, AGAIN_MS);
  source.onopen = () => handlers.connection("open");
  source.onerror = () => {
    handlers.connection("waiting");
    // The browser itself tries again after a broken connection, not after a refusal.
    if (source.readyState !== EventSource.CLOSED) return;
    clearInterval(watch);
    setTimeout(again, AGAIN_MS);
  };
  /**
   * @template T
   * @param {string} name
   * @param {(message: T) => void} take
   */
  const on = (name, take) => source.addEventListener(name, (event) => {
    heard = performance.now();
    take(JSON.parse(event.data));
  });
  on("status", handlers.status);
  on("window", handlers.window);
  on("wave", handlers.wave);
  on("events", handlers.events);
  on("alive", handlers.alive);
  on("lost", handlers.lost);
}
