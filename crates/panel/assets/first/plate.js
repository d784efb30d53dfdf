// Step 1: the nameplate as a form, or a motor file. The server reads what is typed; its words stand at the field.

import { make, say, show } from "../dom.js";
import { shown } from "../format.js";
import * as server from "../workbench/server.js";

/** @typedef {import("../workbench/messages").Question} Question */
/** @typedef {import("../workbench/messages").PlateRow} PlateRow */
/** @typedef {import("../workbench/messages").View} View */
/** @typedef {"iec" | "nema"} Standard */

/** From the last key to the question what the numbers come to, ms. */
const PAUSE_MS = 500;

const idOf = (/** @type {string} */ key) => `plate-${key}`;

/**
 * Whether a plate of this kind has the number.
 * @param {Question} question
 * @param {Standard} standard
 */
export function isAsked({ on }, standard) {
  return on === "every" || on === "elsewhere" || on === standard;
}

/**
 * What a number that is not printed is expected to be.
 * @param {string} key
 * @param {PlateRow[]} plate
 * @returns {string}
 */
export function expected(key, plate) {
  const row = plate.find(({ name }) => name === key);
  if (!row || row.printed !== null) return "";
  return `expected: ${shown(row.circuit)} (95 %: ${shown(row.low)} to ${shown(row.high)})`;
}

/**
 * The answers that are not empty, of the questions that are asked.
 * @param {Question[]} questions
 * @param {Standard} standard
 * @param {(key: string) => string} textOf
 * @returns {Record<string, string>}
 */
export function answers(questions, standard, textOf) {
  const asked = questions.filter((question) => isAsked(question, standard)).map(({ key }) => /** @type {[string, string]} */ ([key, textOf(key).trim()]));
  return Object.fromEntries(asked.filter(([, text]) => text !== ""));
}

/** @param {Question} question */
function field(question) {
  const { key, words, unit, range, missing } = question;
  const id = idOf(key);
  const described = `${id}-hint ${id}-problem`;
  const input = key === "connection"
    ? make("select", { id, name: key, "aria-describedby": described }, make("option", { value: "" }, "not printed"), make("option", { value: "star" }, "star (Y)"), make("option", { value: "delta" }, "delta (Δ)"))
    : make("input", { id, name: key, inputmode: key === "name" || key === "nema_code" ? "text" : "decimal", autocomplete: "off", spellcheck: "false", "aria-describedby": described });
  const needed = missing === "needed";
  const hint = make("p", { class: "hint", id: `${id}-hint`, "data-missing": missing }, needed ? range : `${range}; empty: ${missing}`);
  return make("div", { class: "field", "data-key": key, "data-on": question.on }, make("label", { for: id }, words, needed ? make("b", {}, " *") : ""), make("span", { class: "entry" }, input, make("span", { class: "unit" }, unit)), hint, make("p", { class: "problem", id: `${id}-problem`, hidden: true }));
}

/** @param {string} key */
function input(key) {
  const found = document.getElementById(idOf(key));
  return found instanceof HTMLInputElement || found instanceof HTMLSelectElement ? found : null;
}

/** The form; it keeps what is typed while the rest of the page is drawn anew. */
export class PlateForm {
  /**
   * @param {Question[]} questions
   * @param {(work: () => Promise<View>) => Promise<void>} take
   */
  constructor(questions, take) {
    this.questions = questions;
    this.take = take;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    this.asked = 0;
    this.standard = /** @type {Standard} */ ("iec");
    this.said = make("div", { class: "said-of-plate", "aria-live": "polite" });
    this.problem = make("p", { class: "problem", role: "alert", id: "plate-problem", hidden: true });
    this.element = this.build();
  }

  build() {
    const radio = (/** @type {Standard} */ value, /** @type {string} */ words) => {
      const made = make("input", { type: "radio", name: "standard", id: `standard-${value}`, value, checked: value === "iec" });
      made.addEventListener("change", () => this.choose(value));
      return make("label", {}, made, ` ${words}`);
    };
    const fields = (/** @type {(question: Question) => boolean} */ which) => make("div", { class: "fields" }, ...this.questions.filter(which).map(field));
    const file = make("input", { type: "file", id: "first-motor-file", accept: ".toml" });
    file.addEventListener("change", () => {
      const [chosen] = file.files ?? [];
      if (chosen) this.send(() => server.upload(`/check/motor?name=${encodeURIComponent(chosen.name)}`, chosen));
    });
    const form = make("form", { class: "plate", novalidate: true, "aria-labelledby": "step-1-title" },
      make("p", { class: "subtle" }, "Write the digits as they are printed: they say how far a number may be rounded. Leave out what the plate does not say."),
      make("fieldset", { class: "options" }, make("legend", {}, "The plate is"), radio("iec", "IEC: kW"), radio("nema", "NEMA: hp, code letter")),
      fields(({ on, key }) => on !== "elsewhere" || key === "name"),
      make("details", {}, make("summary", {}, "More from a catalogue, a test sheet or a measurement"), fields(({ on, key }) => on === "elsewhere" && key !== "name")),
      this.said, this.problem,
      make("p", { class: "actions" }, make("button", { type: "submit", class: "main", id: "plate-continue" }, "Continue"), make("span", { class: "options" }, make("label", { for: file.id }, "or take a motor file "), file)));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.send(() => server.send("/check/plate", this.typed()));
    });
    form.addEventListener("input", (event) => {
      if (event.target !== file) this.later();
    });
    return form;
  }

  typed() {
    return answers(this.questions, this.standard, (key) => input(key)?.value ?? "");
  }

  /** @param {Standard} standard */
  choose(standard) {
    this.standard = standard;
    for (const question of this.questions) {
      const row = this.element.querySelector(`[data-key="${question.key}"]`);
      if (row instanceof HTMLElement) show(row, isAsked(question, standard));
    }
  }

  /**
   * What was typed on another page, or before this one was loaded.
   * @param {Record<string, string>} typed
   */
  fill(typed) {
    if (Object.keys(this.typed()).length > 0) return;
    const nema = this.questions.some(({ key, on }) => on === "nema" && key in typed);
    const chosen = this.element.querySelector(`#standard-${nema ? "nema" : "iec"}`);
    if (chosen instanceof HTMLInputElement) chosen.checked = true;
    this.choose(nema ? "nema" : "iec");
    for (const [key, text] of Object.entries(typed)) {
      const there = input(key);
      if (there) there.value = text;
    }
  }

  later() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.attempt(), PAUSE_MS);
  }

  /** Says what the numbers come to, as far as they are typed. */
  async attempt() {
    const asked = ++this.asked;
    try {
      const { missing, contradictions, plate } = await server.attempt(this.typed());
      if (asked !== this.asked) return;
      this.complain([], "");
      for (const { key } of this.questions) this.hint(key, plate);
      const list = contradictions.map((words) => make("li", {}, make("b", {}, "The plate contradicts itself: "), words));
      const enough = plate.length > 0 && list.length === 0 ? [make("p", { class: "subtle", id: "plate-enough" }, "The numbers go together.")] : [];
      this.said.replaceChildren(...(list.length > 0 ? [make("ul", { class: "findings", id: "plate-contradictions" }, ...list)] : []), ...enough, ...(missing ? [make("p", { class: "subtle", id: "plate-missing" }, `Still open: ${missing}`)] : []));
    } catch (error) {
      if (asked !== this.asked) return;
      this.said.replaceChildren();
      this.refused(error, false);
    }
  }

  /**
   * @param {string} key
   * @param {PlateRow[]} plate
   */
  hint(key, plate) {
    const place = document.getElementById(`${idOf(key)}-hint`);
    const question = this.questions.find((candidate) => candidate.key === key);
    if (!place || !question || question.missing === "needed") return;
    const words = expected(key, plate);
    say(place, words === "" ? `${question.range}; empty: ${question.missing}` : words);
  }

  /** @param {() => Promise<View>} work */
  async send(work) {
    clearTimeout(this.timer);
    this.asked += 1;
    this.complain([], "");
    try {
      await this.take(work);
    } catch (error) {
      this.refused(error, true);
    }
  }

  /**
   * @param {unknown} error
   * @param {boolean} focus
   */
  refused(error, focus) {
    const problems = error instanceof server.Refused ? error.problems.filter(({ key }) => input(key)) : [];
    const words = error instanceof Error ? error.message : String(error);
    this.complain(problems, problems.length > 0 ? "" : words);
    const first = this.element.querySelector("[aria-invalid=true]");
    if (focus && first instanceof HTMLElement) first.focus();
  }

  /**
   * @param {{ key: string, message: string }[]} problems
   * @param {string} words
   */
  complain(problems, words) {
    for (const { key } of this.questions) {
      const problem = problems.find((candidate) => candidate.key === key);
      const place = document.getElementById(`${idOf(key)}-problem`);
      input(key)?.setAttribute("aria-invalid", String(problem !== undefined));
      if (!place) continue;
      say(place, problem?.message ?? "");
      show(place, problem !== undefined);
    }
    say(this.problem, words);
    show(this.problem, words !== "");
  }
}
