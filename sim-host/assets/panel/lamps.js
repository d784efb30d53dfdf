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
const STATES = { off: "off", on: "on", blink: "waiting" };

/** @type {Record<string, string>} lit residuals to what to do, for a motor that was not calibrated */
const ADVICE = {
  "r1 r4": "First heat: is the motor hotter than its motor file says? Then terminals, windings, cage.",
  "r1 r3 r4": "Compare the voltage sensors with a meter first: they are likelier than the inductance.",
  "r2 r3 r4": "Bearings and the driven machine; a run without load, or a coast-down, separates the two.",
  "r1 r2 r3": "Compare the current sensors on one wire.",
  "r1 r2 r4": "Check the encoder and its coupling.",
  "r1 r2 r3 r4": "Is it this motor's file? Otherwise an inductance, or several faults at once.",
};

/**
 * What a person should do, from the lamps alone.
 * @param {Lamps} lamps
 * @param {boolean} calibrated
 * @returns {string}
 */
export function advice(lamps, calibrated) {
  if (lamps.sensor === "on") {
    return lamps.run === "on" && lamps.fault === "on" && calibrated
      ? "Compare the named channel with a meter."
      : lamps.run === "on" ? "Compare the sensors with a meter: they are likelier than the motor." : "Cable and supply of the sensor.";
  }
  if (lamps.line === "on" && lamps.run === "off") return "Fuse, contactor.";
  if (lamps.line === "on" && lamps.run === "blink") return "Exchange two phases, of the motor or of the voltage probes.";
  if (lamps.fault === "on") {
    if (calibrated) return "The motor, its terminals or its load: see the likely causes.";
    const lit = /** @type {const} */ (["r1", "r2", "r3", "r4"]).filter((name) => lamps[name] === "on").join(" ");
    return ADVICE[lit] ?? "None of the faults in the table: look at the residuals and the recording itself.";
  }
  if (lamps.line === "on") return "Measure the supply; unbalance above 1 % heats a healthy motor.";
  if (lamps.load === "on") return "Look at the driven machine.";
  if (lamps.sensor === "blink") return "A sensor with a larger range; during a start this is common and goes away.";
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
 * @param {boolean} calibrated
 * @returns {Headline}
 */
export function headline(window, calibrated) {
  const { lamps } = window;
  const todo = advice(lamps, calibrated);
  const found = window.findings.map(sentence).join(" ");
  if (lamps.fault === "on") {
    const top = leading(window.causes).map((cause) => cause.words + (cause.phase ? ` in phase ${cause.phase}` : ""));
    const why = top.length > 0 ? `Likeliest: ${either(top)}.` : window.not_judged ? sentence(window.not_judged) : "";
    return { mood: "bad", title: "Fault", why: [found, why].filter(Boolean).join(" "), todo };
  }
  if (lamps.line === "on") return { mood: "bad", title: "Supply", why: found || sentence(window.not_judged ?? ""), todo };
  if (lamps.load === "on") return { mood: "caution", title: "Overload", why: "More torque than rated.", todo };
  if (lamps.sensor === "on") return { mood: "bad", title: "Sensor", why: found, todo };
  if (window.not_judged) return { mood: "waiting", title: "Not judged", why: sentence(window.not_judged), todo };
  return { mood: "good", title: "Healthy", why: "The motor is being judged, and every residual is within its threshold.", todo };
}

/**
 * The likeliest cause with those that are tied with it.
 * @param {import("./messages").Cause[]} causes
 */
export function leading(causes) {
  const [first] = causes;
  if (!first) return [];
  return first.tie === null ? [first] : causes.filter((cause) => cause.tie === first.tie);
}

/**
 * With a capital and a full stop.
 * @param {string} text
 */
function sentence(text) {
  return text ? `${text[0].toUpperCase()}${text.slice(1)}${text.endsWith(".") ? "" : "."}` : "";
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
  for (const light of door.querySelectorAll("li")) {
    const state = lamps[/** @type {LampName} */ (light.dataset.lamp)];
    if (light.dataset.state === state) continue;
    light.dataset.state = state;
    const word = light.querySelector(".word");
    if (word) say(word, STATES[state]);
  }
}
