// What happened, with the samples around each alarm.

import { byId, make, of, say, send, show } from "./dom.js";
import { clock, either, fixed, moment } from "./format.js";
import { inPhase, leading } from "./lamps.js";

/** @typedef {import("./messages").EventMessage} EventMessage */

/**
 * The likeliest cause of an event in words.
 * @param {EventMessage} event
 * @returns {string}
 */
export function likely(event) {
  if (event.findings.length > 0) return event.findings.join("; ");
  return either(leading(event.causes).map(inPhase)) || "–";
}

/**
 * How long the lamps were lit.
 * @param {EventMessage} event
 * @returns {string}
 */
export function lasting(event) {
  return event.cleared_s === null ? "lit now" : `${fixed(event.cleared_s - event.t_s, 2)} s`;
}

/**
 * Who has seen it, when, and what was said.
 * @param {EventMessage} event
 * @param {Date} [today]
 * @returns {string}
 */
export function seen({ acknowledged }, today) {
  if (!acknowledged) return "–";
  const { by, unix_s, comment } = acknowledged;
  return `${by || "somebody"}, ${moment(unix_s, today)}${comment ? `: ${comment}` : ""}`;
}

/** @param {EventMessage} event */
function row(event) {
  const link = (/** @type {string} */ kind, /** @type {string} */ text) => make("a", { href: `/api/events/${event.id}/recording.${kind}`, download: "", "aria-label": `${text} of the alarm at ${moment(event.unix_s)}` }, text);
  const samples = event.samples > 0 ? [link("csv", "CSV"), " ", link("parquet", "Parquet"), " ", link("toml", "sidecar")] : ["–"];
  return make("tr", { "data-event": event.id, class: event.acknowledged ? "seen" : null },
    make("th", { scope: "row" }, moment(event.unix_s), make("small", { title: "on the source's own clock" }, clock(event.t_s))),
    make("td", { class: "word" }, ...event.lit.map((lamp) => make("span", { class: "tag", "data-lamp": lamp }, lamp.startsWith("r") ? lamp : lamp.toUpperCase()))),
    make("td", { class: "word" }, likely(event)),
    make("td", {}, lasting(event)),
    make("td", { class: "word" }, ...samples),
    make("td", { class: "word comment" }, seen(event)));
}

/** @param {EventMessage[]} events the oldest first */
export function render(events) {
  show(byId("events"), events.length > 0);
  show(byId("events-none"), events.length === 0);
  show(byId("acknowledge"), events.some((event) => !event.acknowledged));
  byId("events").querySelector("tbody")?.replaceChildren(...[...events].reverse().map(row));
}

/** The name is asked once for each browser. */
const NAME = "drivemon-name";

/** @param {Event} event */
async function acknowledge(event) {
  event.preventDefault();
  const [name, comment] = [of("acknowledge-name", HTMLInputElement), of("acknowledge-comment", HTMLInputElement)];
  const refusal = await send("/api/acknowledge", { by: name.value, comment: comment.value });
  show(byId("acknowledge-problem"), refusal !== null);
  say(byId("acknowledge-problem"), refusal?.message ?? "");
  if (refusal) return;
  comment.value = "";
  try {
    localStorage.setItem(NAME, name.value);
  } catch {
    // A browser that keeps nothing asks again.
  }
}

/** Wires the form. */
export function start() {
  byId("acknowledge").addEventListener("submit", acknowledge);
  try {
    of("acknowledge-name", HTMLInputElement).value = localStorage.getItem(NAME) ?? "";
  } catch {
    // As above.
  }
}
