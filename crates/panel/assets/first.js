// The first check of a motor in four steps: plate, recording, is it healthy, answer. The server answers; this page asks.

import { make, say, show } from "./dom.js";
import * as answer from "./first/answer.js";
import { PlateForm } from "./first/plate.js";
import * as recording from "./first/recording.js";
import * as server from "./workbench/server.js";

/** @typedef {import("./workbench/messages").View} View */
/** @typedef {"none" | "this" | "earlier"} Healthy */

/** How often a question is asked how far it is, ms. */
const POLL_MS = 250;
const TITLES = ["The nameplate", "Ten seconds of a recording", "Is it healthy now?", "The answer"];

/**
 * One step: its heading stays, its body changes.
 * @param {string} title
 * @param {number} k
 */
function step(title, k) {
  const number = k + 1;
  const body = make("div", { class: "body", id: `step-${number}-body` });
  const problem = make("p", { class: "problem", role: "alert", id: `step-${number}-problem`, hidden: true });
  const heading = make("h2", { id: `step-${number}-title`, tabindex: "-1" }, make("span", { class: "number", "aria-hidden": "true" }, String(number)), ` ${title}`);
  return { element: make("section", { class: "card step", id: `step-${number}`, "aria-labelledby": heading.id }, heading, body, problem), body, heading, problem };
}

const steps = TITLES.map(step);
const share = make("progress", { max: 1, value: 0, id: "first-share", "aria-label": "Progress", hidden: true });
const stop = make("button", { type: "button", id: "first-stop", hidden: true }, "Stop");
const what = make("p", { class: "what", role: "status", "aria-live": "polite" });
const shownAnswer = make("div", { id: "first-answer", class: "answer" });

/** @type {View | null} */
let view = null;
/** @type {PlateForm | null} */
let plate = null;
let editing = false;
let following = false;
let shownId = -1;
/** @type {() => void} */
let openWorkbench = () => undefined;

/** @param {unknown} error */
const wordsOf = (error) => (error instanceof Error ? error.message : String(error));

/**
 * @param {number} k
 * @param {string} words
 */
function complain(k, words) {
  say(steps[k].problem, words);
  show(steps[k].problem, words !== "");
}

/**
 * How far the path is: the step that is to be done now.
 * @param {View} now
 * @returns {number}
 */
function place(now) {
  if (!now.check) return 0;
  if (!recording.isUsable(now.recordings[0])) return 1;
  return now.results.includes("check") || (now.job.running && now.job.kind === "check") ? 3 : 2;
}

/** @param {number} k */
function goTo(k) {
  steps[k].heading.focus({ preventScroll: true });
  steps[k].element.scrollIntoView({ behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth", block: "start" });
}

/**
 * One change at a time.
 * @param {number} k
 * @param {boolean} now
 */
function busy(k, now) {
  for (const { element } of steps) element.inert = now;
  steps[k].element.classList.toggle("busy", now);
}

/**
 * Does what changes the desk, and moves on where a step is done by it.
 * @param {number} k
 * @param {() => Promise<View>} work
 */
async function change(k, work) {
  const before = view ? place(view) : 0;
  complain(k, "");
  busy(k, true);
  try {
    take(await work());
  } catch (error) {
    const state = await server.state().catch(() => null);
    if (state) take(state);
    throw error;
  } finally {
    busy(k, false);
    // What had the focus is inert or gone: the keyboard goes on from the step.
    steps[k].heading.focus({ preventScroll: true });
  }
  const now = view ? place(view) : 0;
  if (now !== before && !editing) goTo(now);
}

/** @param {number} k */
const changeAt = (k) => async (/** @type {() => Promise<View>} */ work) => {
  try {
    await change(k, work);
    return true;
  } catch (error) {
    complain(k, wordsOf(error));
    return false;
  }
};

/** @param {View} next */
function take(next) {
  view = next;
  const now = editing ? 0 : place(next);
  steps.forEach(({ element, body }, k) => {
    element.dataset.state = k < now ? "done" : k === now ? "now" : "later";
    show(body, k <= now);
  });
  renderPlate(next);
  if (now >= 1) renderRecording(next);
  if (now >= 2) renderHealthy(next);
  renderJob(next);
  if (!next.results.includes("check")) answer.clear(shownAnswer);
}

/** @param {View} next */
function renderPlate(next) {
  if (!plate) return;
  if (!next.check || editing) {
    if (plate.element.parentElement !== steps[0].body) steps[0].body.replaceChildren(plate.element);
    if (next.check) plate.fill(next.check.typed);
    return;
  }
  const { name, by_plate, calibrated, contradictions } = next.check;
  const change = make("button", { type: "button", id: "plate-change" }, "Change");
  change.addEventListener("click", () => {
    editing = true;
    if (view) take(view);
    goTo(0);
  });
  const known = calibrated ? ", known from recordings in good order" : by_plate ? ", by its plate" : ", by its motor file";
  const odd = contradictions.map((words) => make("li", {}, make("b", {}, "The plate contradicts itself: "), words));
  steps[0].body.replaceChildren(make("p", { class: "chosen" }, make("b", {}, name), known, " ", change), ...(odd.length > 0 ? [make("ul", { class: "findings" }, ...odd)] : []));
}

/** @param {View} next */
function renderRecording(next) {
  const [first] = next.recordings;
  const ask = first ? "Another file: drop it here, or choose" : "Drop the file of your recorder here, or choose it";
  const help = make("p", { class: "subtle" }, "Ten seconds of steady running: three currents, at best three voltages and the speed too. CSV, Excel, Parquet, MAT, COMTRADE; a sidecar .toml goes with it.");
  const parts = first ? recording.content(0, first, changeAt(1)) : [help];
  steps[1].body.replaceChildren(recording.drop(0, next, ask, changeAt(1)), ...parts);
}

/** @param {View} next */
function renderHealthy(next) {
  const known = next.check?.calibrated ?? false;
  const button = (/** @type {Healthy} */ healthy, /** @type {string} */ words, /** @type {boolean} */ main) => {
    const made = make("button", { type: "button", class: main ? "main" : null, id: `healthy-${healthy}`, disabled: next.job.running }, words);
    made.addEventListener("click", () => ask(healthy));
    return made;
  };
  const earlier = next.recordings[1];
  const usable = recording.isUsable(earlier);
  const words = known
    ? "This motor is known from a recording in good order. This one is compared with it."
    : "A recording of the motor in good order teaches what is normal: smaller faults show then, with their phase and size.";
  const again = usable && earlier ? [button("earlier", `Compare it with ${earlier.name}`, true)] : [];
  const choices = known
    ? [button("none", "Check it", !usable), button("this", "It is healthy: learn anew from this recording", false)]
    : [button("this", "Yes, it is healthy: learn what is normal", !usable), button("none", "I do not know: judge it as it is", false)];
  const problem = earlier && !usable ? recording.content(1, earlier, changeAt(2)) : [];
  steps[2].body.replaceChildren(make("p", { class: "subtle" }, words),
    make("p", { class: "choices" }, ...again, ...choices),
    recording.drop(1, next, "No, but here is a recording from when it was healthy:", changeAt(2), () => {
      if (recording.isUsable(view?.recordings[1])) ask("earlier");
    }),
    ...problem);
}

/** @param {View} next */
function renderJob({ job }) {
  const mine = job.kind === "check";
  show(share, mine && job.running);
  show(stop, mine && job.running);
  stop.disabled = job.stopping;
  share.value = job.share;
  say(what, mine && job.running ? (job.stopping ? "stopping after this step …" : `${job.what} …`) : "");
  shownAnswer.classList.toggle("waiting", mine && job.running);
}

/**
 * Asks, and follows until there is an answer.
 * @param {Healthy} healthy
 */
async function ask(healthy) {
  complain(2, "");
  try {
    take(await server.send("/jobs", { kind: "check", healthy }));
    goTo(3);
    await follow();
  } catch (error) {
    complain(2, wordsOf(error));
  }
}

async function follow() {
  if (following) return;
  following = true;
  try {
    for (;;) {
      const next = await server.state();
      if (next.job.running) renderJob(next);
      else {
        take(next);
        if (next.job.kind === "check") complain(2, next.job.problem ?? "");
        await openAnswer(next);
        return;
      }
      await new Promise((resolve) => setTimeout(resolve, POLL_MS));
    }
  } finally {
    following = false;
  }
}

/** @param {View} next */
async function openAnswer(next) {
  if (!next.results.includes("check") || (shownId === next.job.id && shownAnswer.dataset.kind)) return;
  shownId = next.job.id;
  const found = await server.result("check");
  answer.render(shownAnswer, found, {
    motor: next.motor?.file ?? "motor.toml",
    workbench: openWorkbench,
    next: () => changeAt(3)(() => server.send("/check/next")),
  });
  goTo(3);
}

/** Shows what another tab or page has changed on the desk. */
export function refresh() {
  server.state().then(async (now) => {
    take(now);
    if (now.job.running) await follow();
    else await openAnswer(now);
  }).catch((error) => complain(0, wordsOf(error)));
}

/**
 * Fills the tab when it is opened for the first time.
 * @param {HTMLElement} holder
 * @param {() => void} workbench opens the workbench
 */
export function start(holder, workbench) {
  openWorkbench = workbench;
  const lead = make("p", { class: "lead" }, "Is this motor in good order? Its plate and ten seconds of a recording are enough for a first answer.");
  holder.replaceChildren(make("div", { class: "desk path" }, lead, ...steps.map(({ element }) => element)));
  steps[3].body.replaceChildren(share, stop, what, shownAnswer);
  stop.addEventListener("click", () => server.stop().then(renderJob).catch((error) => complain(2, wordsOf(error))));
  server.form().then((questions) => {
    plate = new PlateForm(questions, async (work) => {
      editing = false;
      await change(0, work).catch((error) => {
        editing = view?.check !== null;
        if (view) take(view);
        throw error;
      });
    });
    plate.choose("iec");
    refresh();
  }).catch((error) => complain(0, wordsOf(error)));
}
