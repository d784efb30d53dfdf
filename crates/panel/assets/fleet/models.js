// Models in force: by which motor file each motor is judged, since when it is calibrated, what is due.

import { byId, make, of, say, settle, show } from "../dom.js";
import { fixed } from "../format.js";
import { ask } from "./server.js";
import { age } from "./words.js";

/** @typedef {import("./messages").Model} Model */
/** @typedef {import("./messages").Models} Models */

const HEADS = ["Motor", "Motor file", "Effects", "Constants", "Calibrated", "Drift, %", "Due", "Why, or what is not known"];

/** The cell of numbers, behind the motor's name. */
const DRIFT = 4;

/** @type {Models | null} */
let known = null;

/**
 * Whether a motor is asked for.
 * @param {Model} model
 * @param {boolean} due
 * @param {string} search every word of it must be somewhere
 */
export function wanted(model, due, search) {
  if (due && !model.due) return false;
  const text = [model.id, model.title, model.place, model.file ?? "", model.name, ...model.effects, model.why].join(" ").toLowerCase();
  return search.toLowerCase().split(/\s+/).every((word) => text.includes(word));
}

/** @param {Model} model */
function calibrated({ calibrated_on, calibrated_by, learnt }) {
  if (calibrated_on === null) return "not known";
  const by = calibrated_by === "board" ? `learnt by the board, ${learnt}` : "by the file's time";
  return `${calibrated_on}, ${by}`;
}

/**
 * When it is due, in words.
 * @param {Model} model
 * @param {number} now_ms
 */
export function when({ due, due_ms }, now_ms) {
  if (due) return "due";
  return due_ms === null ? "not known" : `in ${age(due_ms - now_ms).split(" ").slice(0, 2).join(" ")}`;
}

/** @param {Model} model */
function constants({ file_constants, board_constants }) {
  if (board_constants === null) return file_constants === null ? "not known" : `${file_constants} by the file`;
  return file_constants === null || file_constants === board_constants ? `${board_constants} by the board` : `board ${board_constants}, file ${file_constants}`;
}

/**
 * @param {Model} model
 * @param {number} now_ms
 */
function row(model, now_ms) {
  const link = make("a", { href: `#motor/${encodeURIComponent(model.id)}` }, model.title);
  const file = model.file === null ? "none named" : [model.name, model.file.split(/[/\\]/).pop()].filter(Boolean).join(", ");
  const texts = [file, model.effects.join(", ") || "–", constants(model), calibrated(model), fixed(model.drift_percent, 2), when(model, now_ms), model.why];
  const cells = texts.map((text, k) => make("td", { class: k === DRIFT ? null : "word", title: k === 0 ? model.file : null }, text));
  return make("tr", { "data-key": model.id, "data-due": String(model.due) }, make("th", { scope: "row" }, link), ...cells);
}

function render() {
  if (!known) return;
  const { models, now_ms, due_after_days, due_drift_percent } = known;
  const found = models.filter((model) => wanted(model, of("due", HTMLInputElement).checked, of("search-models", HTMLInputElement).value.trim()));
  settle(of("models", HTMLTableElement), found.map((model) => row(model, now_ms)));
  const due = models.filter((model) => model.due).length;
  say(byId("models-found"), `${found.length} of ${models.length} motors, ${due} due: older than ${due_after_days} days, r1 or r4 moved by more than ${due_drift_percent} %, other constants than the file's, or never calibrated`);
}

/** Asks anew. */
export async function refresh() {
  const { answer, problem } = await ask("models");
  show(byId("models-problem"), problem !== null);
  say(byId("models-problem"), problem ?? "");
  if (!answer) return;
  known = /** @type {Models} */ (answer);
  render();
}

export function start() {
  of("models", HTMLTableElement).tHead?.append(make("tr", {}, ...HEADS.map((head, k) => make("th", { scope: "col", class: k === DRIFT + 1 ? null : "word" }, head))));
  byId("filter-models").addEventListener("submit", (event) => event.preventDefault());
  byId("due").addEventListener("change", render);
  const month = of("month", HTMLInputElement);
  const link = () => {
    of("month-link", HTMLAnchorElement).href = `/month.html?month=${encodeURIComponent(month.value)}`;
  };
  month.value = new Date().toISOString().slice(0, 7);
  month.addEventListener("input", link);
  link();
  byId("search-models").addEventListener("input", render);
}
