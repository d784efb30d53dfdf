// The live page: messages in, lamps, causes, charts and vectors out.

import * as causes from "./causes.js";
import { Chart } from "./charts.js";
import * as controls from "./controls.js";
import { byId, make, neverShrinks, of, say, show } from "./dom.js";
import * as events from "./events.js";
import * as first from "./first.js";
import { Watch } from "./freshness.js";
import { fixed, rpm, timeOfDay } from "./format.js";
import * as lamps from "./lamps.js";
import * as parameters from "./parameters.js";
import { Series } from "./series.js";
import { listen } from "./stream.js";
import { VectorDiagram } from "./vectors.js";
import * as workbench from "./workbench.js";

/** @typedef {import("./messages").WindowMessage} WindowMessage */
/** @typedef {import("./messages").Status} Status */

/** Charts are drawn at most this often, ms: often enough to look steady, seldom enough for a small computer. */
const REDRAW_MS = 66;
/** Windows that are kept: two minutes at 60 Hz. */
const MOST_WINDOWS = 7200;
const KEYS = ["r1", "r2", "r3", "r4", "slip", "load"];

/** @type {Status | null} */
let status = null;
/** @type {WindowMessage | null} */
let latest = null;
/** @type {import("./messages").WaveMessage | null} */
let wave = null;
let dirty = false;
let drawnAt = 0;
let lost = 0;
let connected = false;
let coordinates = /** @type {"abc" | "dq"} */ ("abc");
const watch = new Watch();
/** Between two looks at the age of what is shown, ms. */
const LOOK_MS = 200;
const series = new Series(KEYS, MOST_WINDOWS);

const residuals = new Chart(byId("chart-residuals"), {
  id: "residuals", title: "r over threshold", x: "time, s", unit: "thresholds", limit: 1, asinh: true, rows: 17,
  lines: [{ label: "r1", color: "blue" }, { label: "r2", color: "vermillion", dash: [9, 4] }, { label: "r3", color: "green", dash: [2, 3] }, { label: "r4", color: "purple", dash: [12, 3, 2, 3] }],
});
const slip = new Chart(byId("chart-slip"), { id: "slip", title: "Slip", x: "time, s", unit: "%", zero: true, rows: 10, lines: [{ label: "slip", color: "blue" }] });
const load = new Chart(byId("chart-load"), { id: "load", title: "Load", x: "time, s", unit: "% of rated", zero: true, rows: 10, lines: [{ label: "air-gap torque", color: "green" }] });
const phases = [{ label: "a", color: "blue" }, { label: "b", color: "vermillion", dash: [9, 4] }, { label: "c", color: "green", dash: [2, 3] }];
const voltage = new Chart(byId("chart-voltage"), { id: "voltage", title: "Voltage", x: "time, ms", unit: "V, instantaneous", rows: 12, lines: phases });
const current = new Chart(byId("chart-current"), { id: "current", title: "Current", x: "time, ms", unit: "A, instantaneous", rows: 12, lines: phases });
const vectors = new VectorDiagram(byId("vectors"));

/** @type {[keyof import("./messages").Operation, string, string, number][]} */
const FIGURES = [
  ["voltage_rms_volt", "Phase voltage", "V rms", 1], ["current_rms_amp", "Phase current", "A rms", 3], ["frequency_hz", "Frequency", "Hz", 2], ["speed_rad_s", "Speed", "rad/s", 1],
  ["slip_percent", "Slip", "%", 2], ["torque_nm", "Air-gap torque", "N m", 3], ["load_percent", "Load", "% of rated", 1],
  ["current_unbalance_percent", "Current unbalance", "%", 2], ["voltage_unbalance_percent", "Voltage unbalance", "%", 2],
];

function buildFigures() {
  for (const [key, label, unit] of FIGURES) {
    const also = key === "speed_rad_s" ? [make("span", { id: "figure-rpm", class: "also" }, "–")] : [];
    byId("operation").append(make("div", {}, make("dt", {}, label), make("dd", { id: `figure-${key}` }, "–"), make("span", { class: "unit" }, unit), ...also));
  }
}

/** Residuals of a window that is not judged. @type {(number | null)[]} */
const NOTHING = [null, null, null, null];

/**
 * Residuals over their thresholds, from percent.
 * @param {(number | null)[]} percent
 */
function overThreshold(percent) {
  const thresholds = status?.threshold_percent;
  return percent.map((r, k) => (r === null || !thresholds ? null : r / thresholds[k]));
}

/** @param {WindowMessage} window */
function takeWindow(window) {
  // Also what is not compared, as of an undeclared load: the table shows it, and so does the history. Where nothing is judged, as in a
  // transient, there is no line.
  const over = window.not_judged === null ? overThreshold(window.r_percent ?? NOTHING) : NOTHING;
  series.push(window.t_s, [...over, window.operation.slip_percent, window.operation.load_percent]);
  latest = window;
  dirty = true;
  watch.window();
  freshen();
}

async function takeHistory() {
  const answer = await fetch("/api/history");
  /** @type {import("./messages").HistoryRow[]} */
  const rows = await answer.json();
  const newest = rows[rows.length - 1]?.t_s ?? -Infinity;
  const later = series.t.map((t, k) => ({ t, row: series.columns.map((column) => column[k]) })).filter(({ t }) => t > newest);
  series.clear();
  const number = (/** @type {unknown} */ value) => (typeof value === "number" ? value : null);
  for (const row of rows) {
    const r = row.judged ? ["r1_percent", "r2_percent", "r3_percent", "r4_percent"].map((key) => number(row[key])) : NOTHING;
    series.push(row.t_s, [...overThreshold(r), number(row.slip_percent), number(row.load_percent)]);
  }
  later.forEach(({ t, row }) => series.push(t, row));
  dirty = true;
}

/** @param {Status} next */
function takeStatus(next) {
  const another = status?.session !== next.session;
  status = next;
  watch.heard.speed = next.speed;
  say(byId("source-name"), next.motor ?? next.source.name);
  document.title = `${next.source.name} – drivemon panel`;
  controls.render(next);
  parameters.render(next);
  audit(next);
  if (another) takeHistory().catch(() => undefined);
  dirty = true;
}

/** @param {Status} next */
function audit(next) {
  const list = byId("audit");
  show(list, next.source.audit.length > 0);
  list.replaceChildren(...next.source.audit.map((finding) => make("li", { class: finding.refuses ? "refuses" : null }, make("b", {}, finding.code), ` ${finding.detail}`)));
}

async function takeStatusNow() {
  const answer = await fetch("/api/status");
  takeStatus(await answer.json());
}

/** @param {"open" | "waiting"} state */
function connection(state) {
  connected = state === "open";
  if (!connected) lost = 0;
  freshen();
}

/** Grey as soon as nothing comes any more, whatever the reason; by itself as before when it comes again. */
function freshen() {
  const old = watch.stale();
  if (document.body.classList.toggle("stale", old)) renderStale();
  else if (latest && byId("state").dataset.mood === "stale") dirty = true;
  pill(old);
}

/** @param {boolean} old */
function pill(old) {
  const rests = watch.heard.rests ? (status?.paused ? "paused" : "ended") : null;
  byId("connection").dataset.state = connected && !old ? "open" : "waiting";
  say(byId("connection"), !connected ? "reconnecting …" : old ? "no data" : rests ?? (lost > 0 ? `live, ${lost} messages lost` : "live"));
}

/** Nothing is known any more: neither lamps nor causes. */
function renderStale() {
  dirty = false;
  byId("state").dataset.mood = "stale";
  say(byId("state-title"), `No data since ${timeOfDay(watch.since)}`);
  say(byId("state-why"), status?.failure ?? "The panel does not hear from its source. What is grey was true then; what is true now is not known.");
  say(byId("state-do"), status?.failure ? "" : "Is the panel still running, and the network up? It goes on by itself.");
  lamps.blank(byId("door"));
  causes.blank();
}

/** @param {WindowMessage} window */
function renderState(window) {
  const { mood, title, why, todo } = lamps.headline(window);
  byId("state").dataset.mood = mood;
  say(byId("state-title"), title);
  say(byId("state-why"), why);
  say(byId("state-do"), todo);
  lamps.render(byId("door"), window.lamps);
}

/** @param {WindowMessage} window */
function renderNumbers(window) {
  const cells = (/** @type {string} */ id) => [...byId(id).querySelectorAll("td")];
  cells("row-percent").forEach((cell, k) => {
    say(cell, fixed(window.r_percent?.[k], 2));
    cell.classList.toggle("off", Math.abs(window.r_over_threshold?.[k] ?? 0) > 1);
  });
  cells("row-threshold").forEach((cell, k) => say(cell, fixed(status?.threshold_percent?.[k], 2)));
  for (const [key, , , decimals] of FIGURES) say(byId(`figure-${key}`), fixed(window.operation[key], decimals));
  const { speed_rad_s } = window.operation;
  say(byId("figure-rpm"), speed_rad_s === null ? "" : `${fixed(rpm(speed_rad_s), 0)} rpm`);
}

function renderWaves() {
  if (!wave) return;
  const [u, i] = coordinates === "abc" ? [wave.u_abc_volt, wave.i_abc_amp] : [wave.u_dq_volt, wave.i_dq_amp];
  const padded = (/** @type {number[][]} */ columns) => [0, 1, 2].map((k) => columns[k] ?? wave?.t_ms.map(() => null) ?? []);
  voltage.update([wave.t_ms, ...padded(u)], 0);
  current.update([wave.t_ms, ...padded(i)], 0);
  wave = null;
}

function draw() {
  const span = Number(of("span", HTMLSelectElement).value);
  residuals.update(series.last(span, ["r1", "r2", "r3", "r4"]), span);
  slip.update(series.last(span, ["slip"]), span);
  load.update(series.last(span, ["load"]), span);
  renderWaves();
}

/** @param {number} now */
function frame(now) {
  requestAnimationFrame(frame);
  if (latest && dirty && now - drawnAt >= REDRAW_MS && !watch.stale()) {
    drawnAt = now;
    dirty = false;
    renderState(latest);
    renderNumbers(latest);
    causes.render(latest);
    vectors.render(latest, status?.rated ?? null);
    controls.tick(latest.t_s);
    draw();
  }
}

/** @param {"abc" | "dq"} chosen */
function choose(chosen) {
  coordinates = chosen;
  byId("waves-abc").setAttribute("aria-pressed", String(chosen === "abc"));
  byId("waves-dq").setAttribute("aria-pressed", String(chosen === "dq"));
  const names = chosen === "abc" ? ["a", "b", "c"] : ["d", "q", ""];
  for (const chart of [voltage, current]) {
    chart.spec.lines = phases.map((line, k) => ({ ...line, label: names[k] }));
    chart.spec.unit = `${chart === voltage ? "V" : "A"}, ${chosen === "abc" ? "instantaneous" : "amplitude"}`;
    chart.rebuild();
  }
}

function tabs() {
  const all = ["live", "first", "workbench"].map((name) => ({ tab: byId(`tab-${name}`), view: byId(`view-${name}`) }));
  const begin = [() => undefined, () => first.start(all[1].view, () => open(2)), () => workbench.start(all[2].view)];
  const again = [() => undefined, first.refresh, workbench.refresh];
  const started = [true, false, false];
  const open = (/** @type {number} */ chosen) => {
    all.forEach(({ tab, view }, k) => {
      tab.setAttribute("aria-selected", String(k === chosen));
      tab.tabIndex = k === chosen ? 0 : -1;
      show(view, k === chosen);
    });
    // Both tabs show one desk: what the other changed is fetched.
    if (started[chosen]) again[chosen]();
    else begin[chosen]();
    started[chosen] = true;
  };
  all.forEach(({ tab }, k) => {
    tab.addEventListener("click", () => open(k));
    tab.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: all.length - 1 }[event.key];
      if (!step) return;
      const next = (k + step) % all.length;
      open(next);
      all[next].tab.focus();
    });
  });
  for (const id of ["tabs", "tab-first", "tab-workbench"]) show(byId(id), workbench.ready);
}

// The cookie has taken the token's place: it need not stay in sight and in the history.
if (location.search) history.replaceState(null, "", location.pathname);
lamps.build(byId("door"));
buildFigures();
document.querySelectorAll("[data-never-shrinks]").forEach((element) => element instanceof HTMLElement && neverShrinks(element));
controls.start();
parameters.start();
events.start();
tabs();
byId("waves-abc").addEventListener("click", () => choose("abc"));
byId("waves-dq").addEventListener("click", () => choose("dq"));
byId("span").addEventListener("change", () => (dirty = true));
requestAnimationFrame(frame);
setInterval(freshen, LOOK_MS);
listen({
  connection, status: takeStatus, window: takeWindow, events: events.render,
  wave: (message) => (wave = message),
  alive: ({ rests }) => watch.alive(rests),
  lost: (messages) => {
    lost += messages;
    // A status may have been among them, and none comes again until something changes.
    takeStatusNow().catch(() => undefined);
    byId("connection").title = "this page could not follow; the source did not wait for it";
  },
});
