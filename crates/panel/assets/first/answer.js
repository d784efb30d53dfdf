// Step 4: the answer as the command's report shows it, and what to do with it.

import { make } from "../dom.js";
import * as results from "../workbench/results.js";

/** @typedef {import("../workbench/messages").Answer} Answer */

/**
 * What can be done from here.
 * @typedef {object} Steps
 * @property {() => void} workbench
 * @property {() => void} next
 * @property {string} motor name of the motor file
 */

/** @param {Steps} steps */
function actions({ workbench, next, motor }) {
  const button = (/** @type {string} */ id, /** @type {string} */ words, /** @type {() => void} */ act) => {
    const made = make("button", { type: "button", id }, words);
    made.addEventListener("click", act);
    return made;
  };
  return make("p", { class: "actions", id: "first-actions" },
    make("a", { class: "button", id: "first-save-motor", href: "/api/workbench/motor.toml", download: motor }, "Save motor file"),
    make("a", { class: "button", id: "first-save-report", href: "/api/workbench/check/report.html", download: "check.html" }, "Save report"),
    button("first-workbench", "Open in workbench", workbench),
    button("first-next", "Check another recording of this motor", next));
}

/**
 * @param {HTMLElement} holder
 * @param {Answer} answer
 * @param {Steps} steps
 */
export function render(holder, answer, steps) {
  results.put(holder, "check", answer);
  const verdict = holder.querySelector(".sides") ?? holder.lastElementChild;
  verdict?.after(actions(steps));
}

export const clear = results.clear;
