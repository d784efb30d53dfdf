// Alarms: what waits for a person, and what a person does about it.

import { byId, make, of, say, settle, show } from "../dom.js";
import { fixed, moment } from "../format.js";
import { mayAct, signIn } from "./account.js";
import { ask, send } from "./server.js";
import { STATES, age } from "./words.js";

/** @typedef {import("./messages").Alarm} Alarm */
/** @typedef {"acknowledge" | "shelve" | "unshelve"} Action */

/** @type {Record<Action, string>} */
const ACTIONS = { acknowledge: "Acknowledge", shelve: "Shelve", unshelve: "End the shelf" };
const SHAPES = { high: "▲ high", medium: "◆ medium", low: "● low" };
const HEADS = ["Severity", "Motor", "What", "State", "Rose", "Evidence", ""];

/**
 * What a person can do about an alarm.
 * @param {Pick<Alarm, "state">} alarm
 * @returns {Action[]}
 */
export function actions({ state }) {
  if (state === "shelved") return ["unshelve"];
  if (state === "normal" || state === "suppressed") return [];
  return state === "acknowledged" ? ["shelve"] : ["acknowledge", "shelve"];
}

/** @type {() => void} */
let changed = () => {};
/** @type {{ alarm: Alarm, action: Action } | null} */
let asked = null;
/** Alarms as they were shown last, by number: a button outlives the answer that it was made from. @type {Map<number, Alarm>} */
const known = new Map();

/**
 * @param {Alarm} alarm
 * @param {Action} action
 */
function open(alarm, action) {
  if (!mayAct()) return signIn();
  asked = { alarm, action };
  say(byId("act-title"), `${ACTIONS[action]} alarm ${alarm.number}`);
  say(byId("act-what"), [alarm.motor, alarm.words].filter(Boolean).join(": "));
  say(byId("act-label"), action === "shelve" ? "Reason" : "Comment");
  of("act-why", HTMLInputElement).required = action === "shelve";
  show(byId("act-for"), action === "shelve");
  show(byId("act-problem"), false);
  say(byId("act-do"), ACTIONS[action]);
  of("act", HTMLDialogElement).showModal();
}

/** @param {Event} event */
async function submit(event) {
  event.preventDefault();
  if (!asked) return;
  const { alarm, action } = asked;
  const why = of("act-why", HTMLInputElement);
  const minutes = action === "shelve" ? { minutes: Number(of("act-minutes", HTMLSelectElement).value) } : {};
  const { answer, problem } = await send(`alarms/${alarm.number}/${action}`, { why: why.value, ...minutes });
  const done = /** @type {import("./messages").Done | null} */ (answer);
  const said = problem ?? (done && !done.done ? done.message : "");
  show(byId("act-problem"), said !== "");
  say(byId("act-problem"), said);
  if (said !== "") return;
  why.value = "";
  of("act", HTMLDialogElement).close();
  changed();
}

/**
 * The recording of an alarm as a file, or why there is none.
 * @param {Alarm} alarm
 * @returns {(Node | string)[]}
 */
function recording(alarm) {
  if (alarm.recording) return ["; ", make("a", { href: `/api/fleet/alarms/${alarm.number}/recording`, download: `alarm-${alarm.number}.csv` }, "recording")];
  return alarm.cause === "fault" && alarm.no_recording ? [`; no recording: ${alarm.no_recording}`] : [];
}

/**
 * @param {Alarm} alarm
 * @param {number} now_ms
 * @param {boolean} named whether the motor is named
 */
function row(alarm, now_ms, named) {
  const motor = alarm.motor ? make("a", { href: `#motor/${encodeURIComponent(alarm.motor)}` }, alarm.motor) : "the plant";
  const times = alarm.times > 1 ? `, ${alarm.times} times` : "";
  const until = alarm.shelved_until_ms ? ` until ${moment(alarm.shelved_until_ms / 1000)}` : "";
  const size = alarm.size_percent === null ? "" : `, ${fixed(alarm.size_percent, 1)} % of scale`;
  const buttons = actions(alarm).map((action) => {
    const button = make("button", { type: "button", "data-action": action, class: action === "acknowledge" ? "main" : null, "aria-label": `${ACTIONS[action]} alarm ${alarm.number}` }, ACTIONS[action]);
    button.addEventListener("click", () => open(known.get(alarm.number) ?? alarm, action));
    return button;
  });
  const head = named ? [make("th", { scope: "row" }, motor)] : [];
  known.set(alarm.number, alarm);
  return make("tr", { "data-key": alarm.number, "data-number": alarm.number, "data-state": alarm.state, "data-severity": alarm.severity },
    make("td", { class: "word severity" }, SHAPES[alarm.severity]), ...head,
    make("td", { class: "word" }, alarm.words + size),
    make("td", { class: "word" }, STATES[alarm.state] + until + (alarm.present || alarm.state === "normal" || alarm.state === "returned_unacknowledged" ? "" : ", condition gone")),
    make("td", { class: "word" }, `${moment(alarm.raised_ms / 1000)}, ${age(now_ms - alarm.raised_ms)} ago${times}`),
    make("td", { class: "word" }, alarm.evidence, ...recording(alarm)),
    make("td", { class: "word acts" }, ...buttons));
}

/**
 * A table of alarms.
 * @param {HTMLTableElement} table
 * @param {Alarm[]} alarms
 * @param {number} now_ms
 * @param {boolean} named whether motors are named
 */
export function draw(table, alarms, now_ms, named) {
  const heads = HEADS.filter((head) => named || head !== "Motor");
  const focus = document.activeElement?.getAttribute("aria-label");
  table.querySelector("thead")?.replaceChildren(make("tr", {}, ...heads.map((head) => make("th", { scope: "col", class: "word" }, head))));
  settle(table, alarms.map((alarm) => row(alarm, now_ms, named)));
  if (focus) for (const button of table.querySelectorAll("button")) if (button.getAttribute("aria-label") === focus) button.focus();
}

/** Asks for the list and shows it. */
export async function refresh() {
  const { answer } = await ask("alarms", { show: of("which", HTMLSelectElement).value });
  if (!answer) return;
  const { alarms, now_ms } = /** @type {{ alarms: Alarm[], now_ms: number }} */ (answer);
  show(byId("alarms-none"), alarms.length === 0);
  show(byId("alarms"), alarms.length > 0);
  draw(of("alarms", HTMLTableElement), alarms, now_ms, true);
}

/**
 * Wires the dialog.
 * @param {() => void} then
 */
export function start(then) {
  changed = then;
  byId("which").addEventListener("change", then);
  byId("act").addEventListener("submit", submit);
  byId("act-cancel").addEventListener("click", () => of("act", HTMLDialogElement).close());
}
