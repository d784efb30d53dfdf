// The server's events, connected again whenever the connection breaks.

/** After the browser has given up it is tried again, ms. */
const AGAIN_MS = 1000;

/**
 * @typedef {object} Handlers
 * @property {(state: "open" | "waiting") => void} connection
 * @property {(status: import("./messages").Status) => void} status
 * @property {(window: import("./messages").WindowMessage) => void} window
 * @property {(wave: import("./messages").WaveMessage) => void} wave
 * @property {(events: import("./messages").EventMessage[]) => void} events
 * @property {(messages: number) => void} lost
 */

/**
 * Listens for ever.
 * @param {Handlers} handlers
 */
export function listen(handlers) {
  const source = new EventSource("/api/stream");
  source.onopen = () => handlers.connection("open");
  source.onerror = () => {
    handlers.connection("waiting");
    // The browser itself tries again after a broken connection, not after a refusal.
    if (source.readyState === EventSource.CLOSED) setTimeout(() => listen(handlers), AGAIN_MS);
  };
  /**
   * @template T
   * @param {string} name
   * @param {(message: T) => void} take
   */
  const on = (name, take) => source.addEventListener(name, (event) => take(JSON.parse(event.data)));
  on("status", handlers.status);
  on("window", handlers.window);
  on("wave", handlers.wave);
  on("events", handlers.events);
  on("lost", handlers.lost);
}
