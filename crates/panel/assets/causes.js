// Likely causes as bars; those that cannot be told apart stand in one bracket.

import { fixed, percent } from "./format.js";
import { byId, make, say, show } from "./dom.js";

/** @typedef {import("./messages").Cause} Cause */

/** Causes that are shown. */
const MOST = 6;

/**
 * Those that are tied with the likeliest together, the others alone.
 * @param {Cause[]} causes the likeliest first
 * @returns {Cause[][]}
 */
export function groups(causes) {
  const tied = causes.filter((cause) => cause.tied);
  const others = causes.filter((cause) => !cause.tied).map((cause) => [cause]);
  return tied.length > 0 ? [tied, ...others] : others;
}

/**
 * Why no cause is shown.
 * @param {import("./messages").WindowMessage} window
 * @returns {string}
 */
export function none(window) {
  if (window.lamps.fault !== "on") return "FAULT is dark: nothing to explain.";
  return "FAULT is lit; this window alone does not say why. The events keep what the windows before said.";
}

/**
 * Name, phase and size in words.
 * @param {Cause} cause
 * @returns {string}
 */
export function named(cause) {
  const phase = cause.phase ? `, phase ${cause.phase}` : "";
  const size = cause.size_percent === null ? "" : ` ${cause.size_percent >= 0 ? "+" : ""}${fixed(cause.size_percent, 0)} %`;
  return `${cause.words}${phase}${size}`;
}

const NO_DATA = "no data";
let drawn = "";

/** @param {import("./messages").WindowMessage} window */
export function render(window) {
  const shown = window.causes.slice(0, MOST);
  const state = JSON.stringify(shown.map((cause) => [named(cause), percent(cause.probability_percent), cause.tied]).concat([[none(window)]]));
  if (state !== drawn) {
    drawn = state;
    byId("causes").replaceChildren(...groups(shown).map(group));
    say(byId("causes-none"), none(window));
    show(byId("causes-none"), shown.length === 0);
  }
  const sigma = window.significance_sigma;
  show(byId("significance"), sigma !== null);
  if (sigma !== null) say(byId("significance"), `${fixed(sigma, 1)} standard deviations from the healthy motor; windings ${fixed(window.resistance_rise_percent, 0)} % above the calibration.`);
}

/** No cause is known while nothing comes. */
export function blank() {
  if (drawn === NO_DATA) return;
  drawn = NO_DATA;
  byId("causes").replaceChildren();
  say(byId("causes-none"), "No data.");
  show(byId("causes-none"), true);
  show(byId("significance"), false);
}

/** @param {Cause[]} causes */
function group(causes) {
  const item = make("li", { class: causes.length > 1 ? "tied" : null, "data-tie": causes.length > 1 });
  if (causes.length > 1) item.append(make("p", { class: "tie" }, "cannot be told apart"));
  for (const cause of causes) {
    const bar = make("i");
    bar.style.inlineSize = `${cause.probability_percent}%`;
    const symbol = cause.name === "unknown" ? [] : [make("abbr", {}, cause.name)];
    item.append(make("p", { class: "cause", "data-cause": cause.name }, make("span", {}, ...symbol, ` ${named(cause)}`), make("b", {}, percent(cause.probability_percent)), make("span", { class: "meter", "aria-hidden": "true" }, bar)));
  }
  return item;
}
