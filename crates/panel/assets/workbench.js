// The workbench: load recordings, compare, explain, adopt, save. The server keeps what lies on it.

import { make, say, show } from "./dom.js";
import * as motor from "./workbench/motor.js";
import * as recordings from "./workbench/recordings.js";
import * as results from "./workbench/results.js";
import * as server from "./workbench/server.js";

/** @typedef {import("./workbench/messages").View} View */
/** @typedef {import("./workbench/messages").Kind} Kind */

/** Whether there is anything to show. */
export const ready = true;

/** How often a question is asked how far it is, ms. */
const POLL_MS = 250;
/** @type {[Kind, string][]} */
const KINDS = [["compare", "Compare"], ["explain", "Explain"], ["adopt", "Adopt"]];

const parts = {
  recordings: make("div", { class: "places" }),
  motor: make("div", {}),
  compare: make("button", { type: "button", class: "main", id: "ask-compare" }, "Compare"),
  explain: make("button", { type: "button", class: "main", id: "ask-explain" }, "Explain"),
  progress: make("progress", { max: 1, value: 0, id: "job-share", "aria-label": "Progress" }),
  stop: make("button", { type: "button", id: "job-stop", hidden: true }, "Stop"),
  what: make("p", { class: "what", role: "status", "aria-live": "polite" }),
  problem: make("p", { class: "problem", role: "alert", id: "workbench-problem", hidden: true }),
  tabs: make("div", { class: "answers", role: "group", "aria-label": "Answers", hidden: true }),
  answer: make("div", { id: "answer", class: "answer", "aria-live": "off" }),
};

/** @type {View | null} */
let view = null;
let shownId = -1;
let following = false;

/** @param {string} words */
function complain(words) {
  say(parts.problem, words);
  show(parts.problem, words !== "");
}

/** @param {unknown} error */
const wordsOf = (error) => (error instanceof Error ? error.message : String(error));

/**
 * Does what changes the desk; a refusal is said at the input with this id, or below the buttons.
 * @type {import("./workbench/recordings.js").Change}
 */
async function change(work, at) {
  complain("");
  say(parts.what, "Reading …");
  busy(true);
  try {
    take(await work());
    say(parts.what, "");
  } catch (error) {
    say(parts.what, "");
    const state = await server.state().catch(() => null);
    if (state) take(state);
    if (!sayAt(at ?? "", wordsOf(error))) complain(wordsOf(error));
  } finally {
    busy(false);
  }
}

/**
 * Says what is wrong beside an input; whether there is such an input.
 * @param {string} id
 * @param {string} words
 */
function sayAt(id, words) {
  const input = document.getElementById(id);
  if (!input?.checkVisibility()) return false;
  document.getElementById(`${id}-problem`)?.remove();
  input.parentElement?.after(make("p", { class: "problem", role: "alert", id: `${id}-problem` }, words));
  input.setAttribute("aria-invalid", "true");
  input.setAttribute("aria-describedby", `${id}-problem`);
  input.focus();
  return true;
}

/**
 * One change at a time.
 * @param {boolean} now
 */
function busy(now) {
  for (const part of [parts.recordings, parts.motor]) part.inert = now;
}

/** @param {View} next */
function take(next) {
  view = next;
  recordings.render(parts.recordings, next, change);
  motor.render(parts.motor, next, change);
  progress(next);
  if (!next.results.some((kind) => kind === parts.answer.dataset.kind)) results.clear(parts.answer);
  tabs(next);
}

/** @param {View} next */
function progress({ recordings: loaded, motor: chosen, job }) {
  const can = !job.running && chosen !== null && loaded.some((recording) => recording?.summary);
  for (const button of [parts.compare, parts.explain]) button.disabled = !can;
  show(parts.progress, job.running);
  show(parts.stop, job.running);
  parts.stop.disabled = job.stopping;
  parts.progress.value = job.share;
  if (job.running) say(parts.what, job.stopping ? "stopping after this step …" : `${job.what} …`);
  parts.answer.classList.toggle("waiting", job.running);
}

/** @param {View} next */
function tabs(next) {
  show(parts.tabs, KINDS.filter(([kind]) => next.results.includes(kind)).length > 1);
  parts.tabs.replaceChildren(...KINDS.filter(([kind]) => next.results.includes(kind)).map(([kind, words]) => {
    const button = make("button", { type: "button", "aria-pressed": String(parts.answer.dataset.kind === kind) }, words);
    button.addEventListener("click", () => open(kind).catch((error) => complain(wordsOf(error))));
    return button;
  }));
}

/** @param {Kind} kind */
async function open(kind) {
  const answer = await server.result(kind);
  results.render(parts.answer, kind, answer, { ask, complain, rated_hz: view?.motor?.frequency_hz ?? 50 });
  if (view) tabs(view);
}

/**
 * Asks, and follows until there is an answer.
 * @param {Kind} kind
 * @param {string} [effect]
 */
async function ask(kind, effect = "") {
  complain("");
  try {
    const begun = await server.send("/jobs", { kind, effect });
    progress(begun);
    parts.what.scrollIntoView({ block: "nearest" });
    await follow();
  } catch (error) {
    complain(wordsOf(error));
  }
}

async function follow() {
  if (following) return;
  following = true;
  await untilAnswered().finally(() => (following = false));
}

async function untilAnswered() {
  for (;;) {
    const next = await server.state();
    if (!next.job.running) {
      take(next);
      say(parts.what, next.job.stopping ? "Stopped; nothing has changed." : "");
      complain(next.job.problem ?? "");
      if (next.job.problem === null && !next.job.stopping && KINDS.some(([kind]) => kind === next.job.kind) && next.job.kind && next.job.id !== shownId) {
        shownId = next.job.id;
        await open(next.job.kind);
        document.getElementById("answer-title")?.focus({ preventScroll: true });
        parts.answer.scrollIntoView({ block: "start" });
      }
      return;
    }
    progress(next);
    await new Promise((resolve) => setTimeout(resolve, POLL_MS));
  }
}

/** @param {View} now */
async function openLast(now) {
  const last = KINDS.map(([kind]) => kind).filter((kind) => now.results.includes(kind)).at(-1);
  if (last) await open(last);
}

/** Shows what another tab has changed on the desk. */
export function refresh() {
  server.state().then(async (now) => {
    take(now);
    if (now.job.running) await follow();
  }).catch((error) => complain(wordsOf(error)));
}

/**
 * Fills the tab when it is opened for the first time.
 * @param {HTMLElement} holder
 */
export function start(holder) {
  const steps = make("section", { class: "card ask", "aria-labelledby": "ask-title" }, make("h3", { id: "ask-title" }, "Questions"), make("p", { class: "subtle" }, "Compare: where does the model of the motor file fail, nothing refitted? Explain: which physical effect is missing, proven on data that was not fitted?"), make("p", { class: "actions" }, parts.compare, " ", parts.explain, " ", parts.stop), parts.progress, parts.what, parts.problem);
  holder.replaceChildren(make("div", { class: "desk" }, parts.recordings, make("div", { class: "places" }, parts.motor, steps)), parts.tabs, parts.answer);
  parts.compare.addEventListener("click", () => ask("compare"));
  parts.explain.addEventListener("click", () => ask("explain"));
  parts.stop.addEventListener("click", () => server.stop().then(progress).catch((error) => complain(wordsOf(error))));
  server.state().then(async (first) => {
    take(first);
    if (first.job.running) await follow();
    else await openLast(first);
  }).catch((error) => complain(wordsOf(error)));
}
