// Switches of faults, and the pace of a source.

import { byId, make, of, say, send, show } from "./dom.js";
import { clock, fixed } from "./format.js";

/** @typedef {import("./messages").Status} Status */
/** @typedef {import("./messages").SwitchedFault} SwitchedFault */
/** @typedef {import("./messages").FaultSwitch} FaultSwitch */

/**
 * The faults in force after a switch was pressed.
 * @param {SwitchedFault[]} faults in force
 * @param {string} name
 * @param {boolean} on
 * @param {number} change_percent
 * @returns {SwitchedFault[]}
 */
export function switched(faults, name, on, change_percent) {
  const others = faults.filter((fault) => fault.name !== name);
  return on ? [...others, { name, change_percent }] : others;
}

/** @type {SwitchedFault[]} */
let inForce = [];
/** Asked for and not yet answered: a status from before must not turn the switches back. */
let asked = 0;
let seeking = false;

/** @param {SwitchedFault[]} faults */
async function put(faults) {
  const before = inForce;
  inForce = faults;
  asked += 1;
  const refusal = await send("/api/faults", { faults });
  asked -= 1;
  if (refusal) inForce = before;
  show(byId("faults-problem"), refusal !== null);
  say(byId("faults-problem"), refusal?.message ?? "");
  if (refusal) mark(inForce);
}

/** @param {FaultSwitch} fault */
function row(fault) {
  const input = make("input", { type: "checkbox", role: "switch", id: `fault-${fault.name}`, "data-fault": fault.name });
  input.addEventListener("change", () => put(switched(inForce, fault.name, input.checked, of("fault-size", HTMLInputElement).valueAsNumber || 0)));
  const size = make("span", { class: "size" });
  const published = fault.table_1 ? pattern(fault.table_1) : "";
  const label = make("label", { for: input.id }, make("abbr", {}, fault.name), ` ${fault.words}`);
  return make("li", {}, input, label, size, published);
}

/** @param {boolean[]} lit */
function pattern(lit) {
  const words = lit.map((on, k) => (on ? `r${k + 1}` : "")).filter(Boolean).join(" ");
  return make("span", { class: "pattern", role: "img", "aria-label": `published: ${words}` }, ...lit.map((on) => make("i", { class: on ? "on" : null })));
}

/** @param {SwitchedFault[]} faults */
function mark(faults) {
  for (const input of document.querySelectorAll("input[data-fault]")) {
    if (!(input instanceof HTMLInputElement)) continue;
    const found = faults.find((fault) => fault.name === input.dataset.fault);
    input.checked = found !== undefined;
    const size = input.parentElement?.querySelector(".size");
    if (size) say(size, found ? `${found.change_percent > 0 ? "+" : ""}${fixed(found.change_percent, 0)} %` : "");
  }
}

/** @param {Status} status */
export function render(status) {
  if (asked === 0) inForce = status.faults;
  show(byId("faults-card"), status.source.can.faults);
  const [table, more] = [byId("faults"), byId("faults-more")];
  if (table.childElementCount === 0 && status.switches.length > 0) {
    table.append(...status.switches.filter((fault) => fault.table_1).map(row));
    more.append(...status.switches.filter((fault) => !fault.table_1).map(row));
  }
  mark(inForce);
  pace(status);
}

/** @param {Status} status */
function pace(status) {
  const { source } = status;
  show(byId("transport"), source.can.pace);
  byId("pause").setAttribute("aria-pressed", String(status.paused));
  say(byId("pause"), status.paused ? "Go on" : "Pause");
  of("speed", HTMLSelectElement).value = String(status.speed);
  show(byId("seek-label"), source.can.seek);
  if (source.span_s) {
    const seek = of("seek", HTMLInputElement);
    [seek.min, seek.max] = source.span_s.map(String);
  }
  const behind = status.behind_s > 0.5 ? `This computer is too slow for that: ${fixed(status.behind_s, 1)} s were left out.` : "";
  say(byId("pace-note"), status.ended ? "The recording has ended; choose a time to play it again." : behind);
}

/** @param {number} t */
export function tick(t) {
  say(byId("clock"), clock(t));
  if (!seeking) of("seek", HTMLInputElement).value = String(t);
}

/** Connects the controls that the page starts with. */
export function start() {
  byId("faults-off").addEventListener("click", () => put([]));
  byId("pause").addEventListener("click", () => send("/api/pause", { paused: byId("pause").getAttribute("aria-pressed") !== "true" }));
  const speed = of("speed", HTMLSelectElement);
  speed.addEventListener("change", () => send("/api/speed", { speed: Number(speed.value) }));
  const seek = of("seek", HTMLInputElement);
  seek.addEventListener("input", () => {
    seeking = true;
    say(byId("clock"), clock(seek.valueAsNumber));
  });
  seek.addEventListener("change", async () => {
    await send("/api/seek", { t_s: seek.valueAsNumber });
    seeking = false;
  });
}
