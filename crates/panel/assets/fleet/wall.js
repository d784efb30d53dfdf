// The wall: every motor at once, the worst large and first, to be read from across a hall.

import { byId, make, say } from "../dom.js";
import { CONDITIONS, age, mark, news, spoken, urgent } from "./words.js";

/** @typedef {import("./messages").Tile} Tile */

/** Width of a cell over its height. */
const ASPECT = 1.75;
/** Large tiles take at most this many cells in each direction. */
const LARGEST = 6;
/** Share of the wall that large tiles may take: most of it, and what is healthy can still be told apart. */
const SHARE = 0.55;
/** A cell may be so many times as high as its width asks for. */
const STRETCH = 1.3;
/** Names that are longer than this are cut where there is no room; the whole name is read out and shown at the pointer. */
const MOST_LETTERS = 14;
/** Smallest height of a cell, px: below that the wall scrolls. */
const LEAST_PX = 26;

/**
 * @typedef {object} Layout
 * @property {number} columns
 * @property {number} span cells of a large tile in each direction
 * @property {number} height of a cell, px
 */

/**
 * Rows that a grid takes which is filled row by row, large tiles first, small ones beside and below them.
 * @param {number} columns
 * @param {number} span
 * @param {number} large
 * @param {number} small
 */
export function rows(columns, span, large, small) {
  const abreast = Math.floor(columns / span);
  if (large > 0 && abreast === 0) return Infinity;
  const bands = large === 0 ? 0 : Math.ceil(large / abreast);
  const beside = bands * span * columns - large * span * span;
  return bands * span + Math.ceil(Math.max(0, small - beside) / columns);
}

/**
 * The largest cells with which everything fits; large tiles as large as their share allows.
 * @param {number} width px
 * @param {number} height px
 * @param {number} large
 * @param {number} small
 * @returns {Layout}
 */
export function layout(width, height, large, small) {
  const all = large + small;
  let best = { columns: Math.max(1, Math.floor(width / (LEAST_PX * ASPECT))), span: 1, height: LEAST_PX };
  let bestScore = 0;
  for (let columns = 1; columns <= Math.max(1, all); columns += 1) {
    const cell = width / columns / ASPECT;
    if (cell < LEAST_PX) break;
    for (let span = 1; span <= LARGEST; span += 1) {
      const taken = rows(columns, span, large, small);
      if (taken * cell > height) continue;
      const cells = Math.floor(height / cell) * columns;
      if (span > 1 && large * span * span > SHARE * cells) continue;
      // What is urgent counts more than what is healthy.
      const score = large > 0 ? cell * (span + 0.5) : cell;
      if (score > bestScore) [best, bestScore] = [{ columns, span: large > 0 ? span : 1, height: cell }, score];
    }
  }
  return best;
}

/** Tiles by motor: the same element stays, so that the focus stays too. */
/** @type {Map<string, HTMLElement>} */
const shown = new Map();

/** @param {Tile} tile */
function build(tile) {
  const link = make("a", { class: "tile", href: `#motor/${encodeURIComponent(tile.id)}` },
    make("span", { class: "shape", "aria-hidden": "true" }), make("b", { class: "name" }), make("span", { class: "how" }), make("span", { class: "news" }));
  const item = make("li", {}, link);
  shown.set(tile.id, item);
  return item;
}

/**
 * @param {HTMLElement} item
 * @param {Tile} tile
 * @param {number} now_ms
 */
function fill(item, tile, now_ms) {
  const link = /** @type {HTMLElement} */ (item.firstElementChild);
  const [shape, word] = CONDITIONS[tile.condition];
  const set = (/** @type {string} */ part, /** @type {string} */ text) => say(/** @type {Element} */ (link.querySelector(part)), text);
  link.dataset.condition = tile.condition;
  link.dataset.alarm = tile.alarm?.state ?? "";
  item.classList.toggle("large", urgent(tile));
  set(".shape", shape);
  set(".name", tile.title);
  const old = tile.condition === "stale" && tile.last ? ` ${age(now_ms - tile.last.time_ms)}` : "";
  set(".how", [word + old, mark(tile)].filter(Boolean).join(" · "));
  set(".news", urgent(tile) ? news(tile) : "");
  const said = spoken(tile, now_ms);
  if (link.getAttribute("aria-label") !== said) {
    link.setAttribute("aria-label", said);
    link.title = said;
  }
}

/** @param {Tile[]} tiles */
function fit(tiles) {
  const list = byId("wall");
  const large = tiles.filter(urgent).length;
  const top = list.getBoundingClientRect().top + scrollY;
  const room = innerHeight - top - parseFloat(getComputedStyle(document.documentElement).fontSize);
  const width = list.clientWidth;
  const { columns, span, height } = layout(width, Math.max(room, 200), large, tiles.length - large);
  // What is left below is shared out.
  const stretched = Math.max(height, Math.min(STRETCH * height, room / rows(columns, span, large, tiles.length - large)));
  const set = (/** @type {string} */ name, /** @type {string} */ value) => list.style.setProperty(name, value);
  set("--columns", String(columns));
  set("--span", String(span));
  set("--cell", `${Math.floor(stretched * 10) / 10}px`);
  set("--width", `${Math.floor(width / columns)}px`);
  set("--letters", String(Math.min(MOST_LETTERS, Math.max(...tiles.map(({ title }) => title.length)))));
}

/**
 * Shows the motors in their order.
 * @param {Tile[]} tiles
 * @param {number} now_ms
 */
export function render(tiles, now_ms) {
  const list = byId("wall");
  const present = new Set(tiles.map((tile) => tile.id));
  for (const [id, item] of shown) {
    if (present.has(id)) continue;
    item.remove();
    shown.delete(id);
  }
  tiles.forEach((tile, k) => {
    const item = shown.get(tile.id) ?? build(tile);
    fill(item, tile, now_ms);
    if (list.children[k] !== item) list.insertBefore(item, list.children[k] ?? null);
  });
  fit(tiles);
}

/**
 * Arrow keys go from tile to tile.
 * @param {KeyboardEvent} event
 */
export function key(event) {
  const items = [...byId("wall").children];
  const at = items.findIndex((item) => item.contains(document.activeElement));
  const columns = Number(byId("wall").style.getPropertyValue("--columns")) || 1;
  const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: columns, ArrowUp: -columns }[event.key];
  if (at < 0 || step === undefined) return;
  const next = items[Math.min(Math.max(at + step, 0), items.length - 1)].firstElementChild;
  if (next instanceof HTMLElement) next.focus();
  event.preventDefault();
}
