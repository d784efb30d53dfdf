// What happened, with the samples around each alarm.

import { byId, make, send, show } from "./dom.js";
import { clock, either, fixed } from "./format.js";
import { leading } from "./lamps.js";

/** @typedef {import("./messages").EventMessage} EventMessage */

/**
 * The likeliest cause of an event in words.
 * @param {EventMessage} event
 * @returns {string}
 */
export function likely(event) {
  if (event.findings.length > 0) return event.findings.join("; ");
  const names = leading(event.causes).map((cause) => cause.words + (cause.phase ? ` in phase ${cause.phase}` : ""));
  return either(names) || "–";
}

/**
 * How long the lamps were lit.
 * @param {EventMessage} event
 * @returns {string}
 */
export function lasting(event) {
  return event.cleared_s === null ? "lit now" : `${fixed(event.cleared_s - event.t_s, 2)} s`;
}

/** @param {EventMessage} event */
function row(event) {
  const link = (/** @type {string} */ kind, /** @type {string} */ text) => make("a", { href: `/api/events/${event.id}/recording.${kind}`, download: "", "aria-label": `${text} of the alarm at ${clock(event.t_s)}` }, text);
  const samples = event.samples > 0 ? [link("csv", "CSV"), " ", link("parquet", "Parquet"), " ", link("toml", "sidecar")] : ["–"];
  return make("tr", { "data-event": event.id, class: event.acknowledged ? "seen" : null },
    make("th", { scope: "row" }, clock(event.t_s)),
    make("td", { class: "word" }, ...event.lit.map((lamp) => make("span", { class: "tag", "data-lamp": lamp }, lamp.startsWith("r") ? lamp : lamp.toUpperCase()))),
    make("td", { class: "word" }, likely(event)),
    make("td", {}, lasting(event)),
    make("td", { class: "word" }, ...samples));
}

/** @param {EventMessage[]} events the oldest first */
export function render(events) {
  show(byId("events"), events.length > 0);
  show(byId("events-none"), events.length === 0);
  byId("events").querySelector("tbody")?.replaceChildren(...[...events].reverse().map(row));
}

/** Wires the button. */
export function start() {
  byId("acknowledge").addEventListener("click", () => send("/api/acknowledge", {}));
}
