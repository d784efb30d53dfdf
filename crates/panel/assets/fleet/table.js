// All motors in a table: filter, search, sort.

import { byId, make, of, say, settle } from "../dom.js";
import { fixed, shown } from "../format.js";
import { order } from "./plant.js";
import { CONDITIONS, age, group, mark, news } from "./words.js";

/** @typedef {import("./messages").Tile} Tile */

/** Rows that are drawn: more nobody reads, and a search finds the others. */
const MOST = 500;

/** @param {Tile} tile */
const largest = (tile) => {
  const known = (tile.last?.residuals_percent ?? []).filter((r) => r !== null).map((r) => Math.abs(/** @type {number} */ (r)));
  return known.length > 0 ? Math.max(...known) : null;
};

/**
 * @typedef {object} Column
 * @property {string} name
 * @property {boolean} word whether it is text
 * @property {(tile: Tile, now_ms: number) => string | number | null} value by which it is sorted
 * @property {(tile: Tile, now_ms: number) => string} [text]
 */

/** @type {Column[]} */
const COLUMNS = [
  { name: "State", word: true, value: (tile) => tile.rank, text: ({ condition }) => CONDITIONS[condition].join(" ") },
  { name: "Motor", word: true, value: (tile) => tile.title },
  { name: "Place", word: true, value: (tile) => tile.place },
  { name: "What", word: true, value: news },
  { name: "Alarm", word: true, value: mark },
  { name: "r, %", word: false, value: largest, text: (tile) => fixed(largest(tile), 1) },
  { name: "V", word: false, value: (tile) => tile.last?.voltage_v ?? null },
  { name: "A", word: false, value: (tile) => tile.last?.current_a ?? null },
  { name: "Hz", word: false, value: (tile) => tile.last?.frequency_hz ?? null },
  { name: "1/min", word: false, value: (tile) => tile.last?.speed_rpm ?? null, text: (tile) => fixed(tile.last?.speed_rpm, 0) },
  { name: "Data", word: false, value: (tile, now_ms) => (tile.last ? now_ms - tile.last.time_ms : null), text: (tile, now_ms) => (tile.last ? age(now_ms - tile.last.time_ms) : "never") },
];

/**
 * Whether a motor is asked for.
 * @param {Tile} tile
 * @param {string} state a group of the count line, `alarm`, or nothing
 * @param {string} search every word of it must be somewhere
 */
export function matches(tile, state, search) {
  if (state === "alarm" && tile.open_alarms === 0) return false;
  if (state !== "" && state !== "alarm" && group(tile.condition) !== state) return false;
  const text = [tile.id, tile.title, tile.place, tile.words, tile.alarm?.words ?? "", CONDITIONS[tile.condition][1]].join(" ").toLowerCase();
  return search.toLowerCase().split(/\s+/).every((word) => text.includes(word));
}

/**
 * Order by a column; what is not known is last in both directions.
 * @param {string | number | null} a
 * @param {string | number | null} b
 * @param {boolean} down
 */
export function compared(a, b, down) {
  if (a === null || b === null) return Number(a === null) - Number(b === null);
  const way = typeof a === "string" ? a.localeCompare(String(b), undefined, { numeric: true }) : a - Number(b);
  return down ? -way : way;
}

let by = 0;
let down = false;
/** @type {() => void} */
let changed = () => {};

/**
 * @param {Tile} tile
 * @param {number} now_ms
 */
function row(tile, now_ms) {
  const cells = COLUMNS.map((column, k) => {
    const value = column.value(tile, now_ms);
    const text = column.text ? column.text(tile, now_ms) : typeof value === "number" || value === null ? shown(value) : value;
    if (k === 1) return make("th", { scope: "row" }, make("a", { href: `#motor/${encodeURIComponent(tile.id)}` }, text));
    return make("td", { class: column.word ? "word" : null }, text);
  });
  return make("tr", { "data-key": tile.id, "data-condition": tile.condition }, ...cells);
}

/**
 * @param {Tile[]} tiles
 * @param {number} now_ms
 */
export function render(tiles, now_ms) {
  const [state, search] = [of("state", HTMLSelectElement).value, of("search", HTMLInputElement).value.trim()];
  const column = COLUMNS[by];
  const found = tiles.filter((tile) => matches(tile, state, search));
  found.sort((a, b) => compared(column.value(a, now_ms), column.value(b, now_ms), down) || order(a, b));
  const focus = document.activeElement instanceof HTMLAnchorElement ? document.activeElement.hash : "";
  settle(of("motors", HTMLTableElement), found.slice(0, MOST).map((tile) => row(tile, now_ms)));
  if (focus) for (const link of byId("motors").querySelectorAll("a")) if (link.hash === focus) link.focus();
  const more = found.length > MOST ? `, the first ${MOST} are shown` : "";
  say(byId("found"), `${found.length} of ${tiles.length} motors${more}`);
}

function heads() {
  byId("heads").replaceChildren(...COLUMNS.map((column, k) => {
    const sorted = k === by ? (down ? "descending" : "ascending") : "none";
    const button = make("button", { type: "button", class: "sort" }, column.name + (k === by ? (down ? " ▾" : " ▴") : ""));
    button.addEventListener("click", () => {
      [by, down] = [k, k === by && !down];
      heads();
      changed();
      byId("heads").querySelectorAll("button")[k].focus();
    });
    return make("th", { scope: "col", "aria-sort": sorted, class: column.word ? "word" : null }, button);
  }));
}

/**
 * Wires filter and heads.
 * @param {() => void} then
 */
export function start(then) {
  changed = then;
  heads();
  byId("filter").addEventListener("submit", (event) => event.preventDefault());
  byId("search").addEventListener("input", then);
  byId("state").addEventListener("change", then);
}
