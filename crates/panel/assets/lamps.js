// The lamps of the panel door: what they show, what it means, what to do. The words are those of docs/lamps.md.

import { either } from "./format.js";
import { make, say } from "./dom.js";

/** @typedef {import("./messages").Lamps} Lamps */
/** @typedef {import("./messages").LampName} LampName */
/** @typedef {import("./messages").WindowMessage} WindowMessage */

/** @type {[LampName, string, string][]} name, text on the door, what it watches */
export const LAMPS = [
  ["run", "RUN", "the motor is being judged"],
  ["r1", "r1", "first residual"],
  ["r2", "r2", "second residual"],
  ["r3", "r3", "third residual"],
  ["r4", "r4", "fourth residual"],
  ["sensor", "SENSOR", "probes and encoder"],
  ["line", "LINE", "the supply"],
  ["load", "LOAD", "load and transients"],
  ["fault", "FAULT", "a fault persists"],
];

/** @type {Record<string, string>} state of a lamp in a word */
const STATES = { off: "off", on: "on", blink: "waiting", unknown: "?" };

/** Names of causes that are a sensor. */
const SENSORS = ["Iq", "Vq", "wr"];

/**
 * What a person should do: about the likeliest causes where there are any, from the lamps otherwise.
 * @param {Pick<WindowMessage, "lamps" | "todo">} window
 * @returns {string}
 */
export function advice({ lamps, todo }) {
  if (lamps.sensor === "on" && lamps.run !== "on") return "Check the sensor's cable and its supply.";
  if (lamps.line === "on" && lamps.run === "off") return "Check fuse and contactor.";
  if (lamps.line === "on" && lamps.run === "blink") return "Exchange two phases, of the motor or of the voltage probes.";
  if (lamps.fault === "on") return todo.map(sentence).join(" ");
  if (lamps.line === "on") return "Measure the supply; unbalance above 1 % heats a healthy motor.";
  if (lamps.load === "on") return "Look at the driven machine.";
  if (lamps.sensor === "on") return "Compare the sensors with a meter: they are likelier than the motor.";
  if (lamps.sensor === "blink") return "Use a sensor with a larger range; during a start this is common and goes away.";
  return "";
}

/**
 * @typedef {object} Headline
 * @property {"good" | "bad" | "caution" | "waiting"} mood
 * @property {string} title
 * @property {string} why
 * @property {string} todo
 */

/**
 * The news in one line, why, and what to do.
 * @param {WindowMessage} window
 * @returns {Headline}
 */
export function headline(window) {
  const { lamps } = window;
  const todo = advice(window);
  const found = window.findings.map(sentence).join(" ");
  if (lamps.fault === "on") return { mood: "bad", title: "Fault", why: reasons(window).join(" "), todo };
  if (lamps.line === "on") return { mood: "bad", title: "Supply", why: found || sentence(window.not_judged ?? ""), todo };
  if (lamps.load === "on") return { mood: "caution", title: "Overload", why: "More torque than rated.", todo };
  if (lamps.sensor === "on") return { mood: "bad", title: "Sensor", why: found, todo };
  if (window.not_judged) return { mood: "waiting", title: "Not judged", why: sentence(window.not_judged), todo };
  const why = window.motion ? "The motor is being judged while current, speed or supply change, and all of it fits." : "The motor is being judged, and every residual is within its threshold.";
  return { mood: "good", title: "Healthy", why, todo };
}

/**
 * Why FAULT is lit, each thing said once.
 * @param {WindowMessage} window
 * @returns {string[]}
 */
function reasons({ findings, causes, not_judged }) {
  const [first] = causes;
  // A sensor that is dead is named by its finding.
  const said = first && findings.length > 0 && SENSORS.includes(first.name) && first.probability_percent > 99.5;
  const parts = [...findings];
  if (first && !said) parts.push(`likeliest: ${either(leading(causes).map(inPhase))}`);
  if (!first && not_judged && !findings.includes(not_judged)) parts.push(`this window is not judged: ${not_judged}`);
  return parts.map(sentence);
}

/**
 * A cause with its phase, in words.
 * @param {import("./messages").Cause} cause
 */
export function inPhase(cause) {
  return cause.words + (cause.phase ? ` in phase ${cause.phase}` : "");
}

/**
 * The likeliest cause with those that are tied with it.
 * @param {import("./messages").Cause[]} causes
 */
export function leading(causes) {
  const tied = causes.filter((cause) => cause.tied);
  return tied.length > 0 ? tied : causes.slice(0, 1);
}

/**
 * With a capital and a full stop.
 * @param {string} text
 */
function sentence(text) {
  return text ? `${text[0].toUpperCase()}${text.slice(1)}${/[.?]$/.test(text) ? "" : "."}` : "";
}

/**
 * Puts the lamps on the door.
 * @param {HTMLElement} door
 */
export function build(door) {
  for (const [name, label, watches] of LAMPS) {
    const state = make("span", { class: "word" }, "off");
    const bulb = make("span", { class: "bulb", "aria-hidden": "true" });
    door.append(make("li", { class: "light", "data-lamp": name, "data-state": "off", title: watches }, bulb, make("b", {}, label), state));
  }
}

/**
 * Shows the lamps of a window.
 * @param {HTMLElement} door
 * @param {Lamps} lamps
 */
export function render(door, lamps) {
  paint(door, (lamp) => lamps[lamp]);
}

/**
 * Shows that no lamp is known.
 * @param {HTMLElement} door
 */
export function blank(door) {
  paint(door, () => "unknown");
}

/**
 * @param {HTMLElement} door
 * @param {(lamp: LampName) => string} of
 */
function paint(door, of) {
  for (const light of door.querySelectorAll("li")) {
    const state = of(/** @type {LampName} */ (light.dataset.lamp));
    if (light.dataset.state === state) continue;
    light.dataset.state = state;
    const word = light.querySelector(".word");
    if (word) say(word, STATES[state]);
  }
}
