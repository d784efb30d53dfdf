// One motor: what is known of it now, its history, its alarms and events.

import { byId, make, of, say, show } from "../dom.js";
import { fixed, moment, shown } from "../format.js";
import * as alarms from "./alarms.js";
import { ask } from "./server.js";
import { Trends } from "./trends.js";
import { CONDITIONS, LAMPS, age, group, news } from "./words.js";

/** @typedef {import("./messages").Motor} Motor */
/** @typedef {import("./messages").Trend} Trend */
/** @typedef {import("./messages").Event} Event */

const HOUR = 3_600_000;
/** @type {[string, number][]} */
const SPANS = [["1 h", HOUR], ["8 h", 8 * HOUR], ["1 day", 24 * HOUR], ["1 week", 168 * HOUR], ["1 month", 730 * HOUR], ["1 year", 8766 * HOUR]];
/** Points of a chart. */
const POINTS = 700;
const EVENTS = 50;
const WORDS = ["off", "on", "waiting"];

let id = "";
let span = HOUR;
/** @type {Trends | null} */
let trends = null;

/** @param {HTMLElement} view */
function build(view) {
  const spans = SPANS.map(([name, ms]) => {
    const button = make("button", { type: "button", "aria-pressed": String(ms === span), "data-span": ms }, name);
    button.addEventListener("click", () => {
      span = ms;
      for (const other of view.querySelectorAll("[data-span]")) other.setAttribute("aria-pressed", String(other === button));
      refresh();
    });
    return button;
  });
  const box = make("div", { id: "trends", class: "trends" });
  view.append(
    make("section", { class: "state", id: "motor-state" }, make("div", {}, make("p", { class: "title", id: "motor-title" }), make("p", { class: "why", id: "motor-why" })), make("ul", { id: "motor-lamps", class: "door", "aria-label": "Lamps" })),
    make("dl", { id: "motor-figures", class: "figures" }),
    make("section", { class: "card" }, make("div", { class: "head" }, make("h2", {}, "Alarms")), make("p", { id: "motor-quiet", class: "subtle" }, "No alarm so far."), make("div", { class: "wide" }, make("table", { id: "motor-alarms" }, make("thead"), make("tbody")))),
    make("section", { class: "card" }, make("div", { class: "head" }, make("h2", {}, "History"), make("div", { class: "tools", role: "group", "aria-label": "Time" }, ...spans)), make("p", { id: "trend-said", class: "subtle" }), box),
    make("section", { class: "card" }, make("h2", {}, "Events"), make("div", { class: "wide" }, make("table", { id: "motor-events" }, make("thead", {}, make("tr", {}, ...["At", "What", "Who"].map((head) => make("th", { scope: "col", class: "word" }, head)))), make("tbody")))),
    make("section", { class: "card" }, make("h2", {}, "Board and motor"), make("dl", { id: "motor-facts", class: "facts" })),
  );
  trends = new Trends(box);
}

/**
 * @param {string} name
 * @param {string} value
 * @param {string} unit
 */
const figure = (name, value, unit) => make("div", {}, make("dt", {}, name), make("dd", {}, value), make("span", { class: "unit" }, unit));

/** @param {Motor} motor */
function now(motor) {
  const { tile, now_ms } = motor;
  const [shape, word] = CONDITIONS[tile.condition];
  const last = tile.last;
  byId("motor-state").dataset.group = group(tile.condition);
  say(byId("motor-title"), `${shape} ${tile.title}: ${word}`);
  const old = last ? `last data ${age(now_ms - last.time_ms)} ago` : "";
  say(byId("motor-why"), [news(tile), tile.place, old].filter(Boolean).join(" · "));
  const fresh = group(tile.condition) !== "stale";
  byId("motor-lamps").replaceChildren(...LAMPS.map((name, k) => {
    const state = fresh ? last?.lamps[k] ?? 0 : -1;
    const shown = state < 0 ? "?" : WORDS[state];
    return make("li", { class: "light", "data-lamp": name.toLowerCase(), "data-state": state < 0 ? "unknown" : ["off", "on", "blink"][state] }, make("span", { class: "bulb", "aria-hidden": "true" }), make("b", {}, name), make("span", { class: "word" }, shown));
  }));
  const r = last?.residuals_percent ?? [];
  byId("motor-figures").replaceChildren(
    figure("Voltage", fixed(last?.voltage_v, 1), "V RMS"), figure("Current", shown(last?.current_a), "A RMS"), figure("Frequency", fixed(last?.frequency_hz, 2), "Hz"), figure("Speed", fixed(last?.speed_rpm, 0), "1/min"),
    ...[0, 1, 2, 3].map((k) => figure(`r${k + 1} of its scale`, fixed(r[k], 2), "%")));
  show(byId("motor-quiet"), motor.alarms.length === 0);
  alarms.draw(of("motor-alarms", HTMLTableElement), motor.alarms, now_ms, false);
  show(byId("motor-alarms"), motor.alarms.length > 0);
  facts(motor);
}

/** @param {Motor} motor */
function facts({ tile, nameplate, link, answers, why, motor_file }) {
  const reached = answers === null ? "not known" : answers ? "answers" : `does not answer: ${why}`;
  const pairs = [["Name", tile.id], ["Nameplate", nameplate], ["Place", tile.place], ["Board", link], ["Link", reached], ["Motor file", motor_file ?? ""]];
  byId("motor-facts").replaceChildren(...pairs.filter(([, value]) => value).flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]),
    make("dt", {}, "Data"), make("dd", {}, make("a", { href: `/api/fleet/motors/${encodeURIComponent(tile.id)}/trend?points=5000`, download: `${tile.id}.json` }, "the last day as JSON"), " ", make("a", { href: `/api/fleet/events?motor=${encodeURIComponent(tile.id)}&limit=2000`, download: `${tile.id}-events.json` }, "events as JSON")));
}

/** @param {Event[]} events */
function happened(events) {
  byId("motor-events").querySelector("tbody")?.replaceChildren(...events.map((event) => make("tr", {},
    make("td", { class: "word" }, moment(event.time_ms / 1000)), make("td", { class: "word" }, event.words), make("td", { class: "word" }, [event.who, event.why].filter(Boolean).join(": ")))));
}

/**
 * Shows everything about the motor, or its title alone: nothing of the motor shown before stays under a name that is not known.
 * @param {boolean} known
 */
function only(known) {
  for (const part of byId("view-motor").children) if (part.id !== "motor-state") show(/** @type {HTMLElement} */ (part), known);
  if (known) return;
  byId("motor-state").dataset.group = "stale";
  say(byId("motor-why"), "");
  byId("motor-lamps").replaceChildren();
}

/** Asks for everything about the motor and shows it. */
export async function refresh() {
  const asked = id;
  const motor = await ask(`motors/${encodeURIComponent(id)}`);
  if (asked !== id) return;
  only(Boolean(motor.answer));
  if (!motor.answer) return say(byId("motor-title"), motor.problem ?? "");
  now(/** @type {Motor} */ (motor.answer));
  const to_ms = /** @type {Motor} */ (motor.answer).now_ms;
  const [trend, events] = await Promise.all([ask(`motors/${encodeURIComponent(id)}/trend`, { from_ms: to_ms - span, to_ms, points: POINTS }), ask("events", { motor: id, limit: EVENTS })]);
  if (asked !== id) return;
  say(byId("trend-said"), trend.problem ?? "");
  if (trend.answer) trends?.show(/** @type {Trend} */ (trend.answer), to_ms - span, to_ms);
  if (events.answer) happened(/** @type {{ events: Event[] }} */ (events.answer).events);
}

/**
 * Shows a motor.
 * @param {string} name
 */
export function open(name) {
  const view = byId("view-motor");
  if (view.childElementCount === 0) build(view);
  if (name !== id) {
    id = name;
    say(byId("motor-title"), name);
  }
  return refresh();
}
