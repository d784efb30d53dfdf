// Answers as the reports of the command line show them, with the next step as a button.

import { make } from "../dom.js";
import { wire } from "./regions.js";

/** @typedef {import("./messages").Answer} Answer */
/** @typedef {import("./messages").Kind} Kind */
/** @typedef {import("./messages").Result} Result */

/** What can be done from here. */
/**
 * @typedef {object} Steps
 * @property {(kind: Kind, effect?: string) => void} ask
 * @property {(words: string) => void} complain
 * @property {number} rated_hz
 */

/** Figures by what holds them. */
/** @type {WeakMap<HTMLElement, import("./messages").Figures>} */
const drawn = new WeakMap();

/**
 * The page's parts; their names become the answer's own, so that they meet no others on the page.
 * @param {string} html
 * @param {string} prefix
 * @returns {Node[]}
 */
function parts(html, prefix) {
  const parsed = new DOMParser().parseFromString(html, "text/html");
  for (const element of parsed.querySelectorAll("[id]")) element.id = `${prefix}-${element.id}`;
  for (const element of parsed.querySelectorAll("[aria-labelledby]")) element.setAttribute("aria-labelledby", `${prefix}-${element.getAttribute("aria-labelledby")}`);
  return [...parsed.body.childNodes].map((node) => document.adoptNode(node));
}

/** @param {HTMLElement} holder */
function applyStyles(holder) {
  for (const element of holder.querySelectorAll("[data-style]")) {
    if (element instanceof HTMLElement) element.style.cssText = element.dataset.style ?? "";
  }
}

/**
 * Names that can be adopted: what was found, what ties with it, then the ranking.
 * @param {Result} result
 * @returns {string[]}
 */
export function adoptable(result) {
  const found = (result.steps ?? []).flatMap((step) => [step.effect, ...step.tied_with]);
  const names = [result.next?.adopt ?? "", ...found, ...(result.ranking ?? []).map((row) => row.effect)];
  return [...new Set(names)].filter((name) => /^[a-z][a-z0-9-]*$/.test(name));
}

/**
 * The next step below an answer.
 * @param {Kind} kind
 * @param {Result} result
 * @param {Steps} steps
 */
function next(kind, result, steps) {
  const button = (/** @type {string} */ words, /** @type {Kind} */ to, effect = "") => {
    const made = make("button", { type: "button", class: "main", "data-ask": to }, words);
    made.addEventListener("click", () => steps.ask(to, effect));
    return made;
  };
  if (kind === "compare") return make("p", { class: "actions" }, button("Explain: which physics is missing?", "explain"));
  if (kind === "adopt") return make("p", { class: "actions" }, button("Explain again: is anything still missing?", "explain"), " ", make("a", { class: "button", href: "/api/workbench/motor.toml", download: true }, "Save motor file"));
  const names = adoptable(result);
  const first = result.next?.adopt;
  const other = make("select", { id: "adopt-other", "aria-label": "Another effect to adopt" }, make("option", { value: "" }, "another effect …"), ...names.filter((name) => name !== first).map((name) => make("option", { value: name }, name)));
  other.addEventListener("change", () => other.value !== "" && steps.ask("adopt", other.value));
  return make("p", { class: "actions" }, ...(first ? [button(`Adopt ${first}`, "adopt", first), " "] : []), ...(names.length > 0 ? [other] : []));
}

/**
 * Shows an answer in place of the one before.
 * @param {HTMLElement} holder
 * @param {Kind} kind
 * @param {Answer} answer
 * @param {Steps} steps
 */
export function render(holder, kind, answer, steps) {
  const figures = put(holder, kind, answer);
  const verdict = holder.querySelector(".verdict");
  const told = holder.querySelector(`[aria-labelledby=${kind}-next] p`);
  (told ?? verdict)?.after(next(kind, answer.result, steps));
  if (kind === "compare") wire(holder, answer.result, figures, steps.rated_hz, steps.complain);
}

/**
 * Puts an answer with its figures in place of the one before.
 * @param {HTMLElement} holder
 * @param {Kind} kind
 * @param {Answer} answer
 */
export function put(holder, kind, answer) {
  clear(holder);
  const title = make("h2", { id: `${holder.id}-title`, class: "answer-title", tabindex: "-1" }, answer.title);
  holder.append(title, ...parts(answer.html, kind));
  holder.dataset.kind = kind;
  applyStyles(holder);
  const figures = globalThis.drawFigures(holder, answer.result);
  drawn.set(holder, figures);
  holder.dataset.charts = String(figures.count);
  return figures;
}

/** @param {HTMLElement} holder */
export function clear(holder) {
  drawn.get(holder)?.remove();
  drawn.delete(holder);
  holder.replaceChildren();
  delete holder.dataset.kind;
}
