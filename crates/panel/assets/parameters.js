// The motor's parameters as inputs; the motor file's own reader checks them, and its words stand at the field.

import { byId, make, of, say, send, show } from "./dom.js";

/** @typedef {import("./messages").Field} Field */

/**
 * Fields whose text is another one than the motor's.
 * @param {Field[]} fields
 * @param {Record<string, string>} typed
 * @returns {Record<string, string>}
 */
export function changed(fields, typed) {
  /** @type {Record<string, string>} */
  const found = {};
  for (const { key, value } of fields) {
    const text = typed[key]?.trim() ?? value;
    if (text !== value && !(text !== "" && Number(text) === Number(value))) found[key] = text;
  }
  return found;
}

/** @type {Field[]} */
let fields = [];
/** @type {Record<string, string> | null} the values that the panel was started with */
let original = null;

const idOf = (/** @type {string} */ key) => `field-${key.replace(".", "-")}`;

/** @param {Field} field */
function row(field) {
  const id = idOf(field.key);
  const input = make("input", { id, name: field.key, inputmode: "decimal", autocomplete: "off", spellcheck: "false", "aria-describedby": `${id}-problem` });
  input.value = field.value;
  const symbol = field.symbol ? [" ", make("abbr", {}, field.symbol)] : [];
  return make("div", { class: "field" }, make("label", { for: id }, field.label, ...symbol), make("span", { class: "entry" }, input, make("span", { class: "unit" }, field.unit)), make("p", { class: "problem", id: `${id}-problem`, hidden: true }));
}

function typed() {
  /** @type {Record<string, string>} */
  const values = {};
  for (const { key } of fields) values[key] = of(idOf(key), HTMLInputElement).value;
  return values;
}

/** @param {import("./messages").Refusal | null} refusal */
function complain(refusal) {
  const rest = (refusal?.problems ?? []).filter((problem) => !fields.some((field) => field.key === problem.key));
  for (const { key } of fields) {
    const problem = refusal?.problems.find((candidate) => candidate.key === key);
    of(idOf(key), HTMLInputElement).setAttribute("aria-invalid", String(problem !== undefined));
    say(byId(`${idOf(key)}-problem`), problem?.message ?? "");
    show(byId(`${idOf(key)}-problem`), problem !== undefined);
  }
  const elsewhere = refusal && (rest.length > 0 || refusal.problems.length === 0);
  const words = elsewhere ? [refusal.message, ...rest.map((problem) => `${problem.key}: ${problem.message}`)].join(" ") : "";
  say(byId("parameters-problem"), words);
  show(byId("parameters-problem"), words !== "");
  const first = document.querySelector("#fields [aria-invalid=true]");
  if (first instanceof HTMLElement) first.focus();
}

/** @param {Record<string, string>} values */
async function apply(values) {
  say(byId("parameters-done"), "");
  const refusal = await send("/api/parameters", values);
  complain(refusal);
  if (!refusal) say(byId("parameters-done"), "Applied: the monitor judges with these values.");
}

/** @param {import("./messages").Status} status */
export function render(status) {
  show(byId("parameters-card"), status.source.can.parameters && status.fields.length > 0);
  const same = fields.length === status.fields.length && status.fields.every((field, k) => field.value === fields[k].value);
  if (same) return;
  fields = status.fields;
  original ??= Object.fromEntries(fields.map(({ key, value }) => [key, value]));
  byId("fields").replaceChildren(...fields.map(row));
}

/** Wires the form. */
export function start() {
  byId("parameters").addEventListener("submit", (event) => {
    event.preventDefault();
    const values = changed(fields, typed());
    if (Object.keys(values).length > 0) apply(values);
    else {
      complain(null);
      say(byId("parameters-done"), "Nothing was changed.");
    }
  });
  byId("parameters-reset").addEventListener("click", () => {
    if (!original) return;
    for (const { key } of fields) of(idOf(key), HTMLInputElement).value = original[key] ?? "";
    apply(original);
  });
}
