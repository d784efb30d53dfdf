// Windows over time, for charts: columns of equal length, the oldest forgotten.

/** Longest time between two windows that a line is drawn across, s. */
const GAP_S = 0.5;

/** Columns over a rising clock. */
export class Series {
  /**
   * @param {string[]} keys
   * @param {number} capacity rows that are kept
   */
  constructor(keys, capacity) {
    this.keys = keys;
    this.capacity = capacity;
    /** @type {number[]} */
    this.t = [];
    /** @type {(number | null)[][]} */
    this.columns = keys.map(() => []);
  }

  clear() {
    this.t = [];
    this.columns = this.keys.map(() => []);
  }

  /**
   * Adds a row. An older clock begins anew; after a gap the lines are interrupted.
   * @param {number} t seconds
   * @param {(number | null)[]} row
   */
  push(t, row) {
    const last = this.t[this.t.length - 1];
    if (last !== undefined && t <= last) this.clear();
    else if (last !== undefined && t - last > GAP_S) this.append((last + t) / 2, row.map(() => null));
    this.append(t, row);
    const over = this.t.length - this.capacity;
    // Cut in blocks: moving a long column for every row would cost more than drawing it.
    if (over > this.capacity / 4) {
      this.t.splice(0, over);
      this.columns.forEach((column) => column.splice(0, over));
    }
  }

  /**
   * @param {number} t
   * @param {(number | null)[]} row
   */
  append(t, row) {
    this.t.push(t);
    this.columns.forEach((column, k) => column.push(row[k] ?? null));
  }

  /**
   * The last seconds, as a chart takes them.
   * @param {number} seconds
   * @param {string[]} keys
   * @returns {[number[], ...(number | null)[][]]}
   */
  last(seconds, keys) {
    const from = firstAfter(this.t, (this.t[this.t.length - 1] ?? 0) - seconds);
    const column = (/** @type {string} */ key) => this.columns[this.keys.indexOf(key)].slice(from);
    return [this.t.slice(from), ...keys.map(column)];
  }
}

/**
 * Place of the first value of a rising list that is not below a limit.
 * @param {number[]} rising
 * @param {number} limit
 * @returns {number}
 */
export function firstAfter(rising, limit) {
  let [low, high] = [0, rising.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (rising[middle] < limit) low = middle + 1;
    else high = middle;
  }
  return low;
}
