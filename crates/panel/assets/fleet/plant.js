// The motors of the plant as they are known now, kept in order.

/** @typedef {import("./messages").Tile} Tile */
/** @typedef {import("./messages").Wall} Wall */
/** @typedef {import("./messages").News} News */

/**
 * The worst first; of equals what rose last. As crates/panel/src/fleet/wall.rs orders them.
 * @param {Tile} a
 * @param {Tile} b
 */
export function order(a, b) {
  if (a.rank !== b.rank) return a.rank - b.rank;
  const raised = (b.alarm?.raised_ms ?? 0) - (a.alarm?.raised_ms ?? 0);
  if (raised !== 0) return raised;
  return a.id < b.id ? -1 : 1;
}

/** All motors. */
export class Plant {
  constructor() {
    /** @type {Map<string, Tile>} */
    this.tiles = new Map();
    /** @type {import("./messages").Counts | null} */
    this.counts = null;
    this.offset_ms = 0;
    this.heard = -Infinity;
  }

  /** @param {Wall} wall */
  all(wall) {
    this.tiles = new Map(wall.motors.map((tile) => [tile.id, tile]));
    this.counts = wall.counts;
    this.clock(wall.now_ms);
  }

  /** @param {News} news */
  news(news) {
    for (const tile of news.motors) this.tiles.set(tile.id, tile);
    for (const id of news.gone) this.tiles.delete(id);
    this.counts = news.counts;
    this.clock(news.now_ms);
  }

  /**
   * The server's clock; this computer's may be another.
   * @param {number} now_ms
   */
  clock(now_ms) {
    this.offset_ms = now_ms - performance.now();
    this.heard = performance.now();
  }

  now() {
    return performance.now() + this.offset_ms;
  }

  /** @returns {Tile[]} */
  sorted() {
    return [...this.tiles.values()].sort(order);
  }
}
