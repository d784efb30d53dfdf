// The page of a plant: which view is shown, and what it is told.

import { byId, make, of, say, show } from "../dom.js";
import { timeOfDay } from "../format.js";
import * as account from "./account.js";
import * as alarms from "./alarms.js";
import * as models from "./models.js";
import * as motor from "./motor.js";
import { Plant } from "./plant.js";
import { ask } from "./server.js";
import { listen } from "./stream.js";
import * as table from "./table.js";
import * as wall from "./wall.js";

/** @typedef {"wall" | "table" | "alarms" | "models" | "motor"} View */

const VIEWS = /** @type {View[]} */ (["wall", "table", "alarms", "models", "motor"]);
/** Numbers in the table and on a motor's page are asked for this often, ms. */
const NUMBERS_MS = 2000;
/** What changes within this time is drawn and asked for once, ms. */
const TOGETHER_MS = 100;

const plant = new Plant();
/** @type {View} */
let view = "wall";
let fresh = false;
let trouble = "";
let since = new Date();
/** @type {ReturnType<typeof setTimeout> | null} */
let due = null;

/** @type {[keyof import("./messages").Counts, string, string][]} count, shape and word; its key is the filter of the table too */
const COUNTS = [
  ["fault", "▲", "fault"], ["attention", "◆", "attention"], ["stale", "?", "no data"], ["not_judged", "◐", "not judged"], ["off", "○", "off"], ["healthy", "✓", "healthy"],
];

/** The count line: built once, so that a click does not miss. */
function buildCounts() {
  const parts = COUNTS.map(([key, shape, word]) => {
    const button = make("button", { type: "button", class: "count", "data-group": key }, make("span", { class: "shape", "aria-hidden": "true" }, shape), make("b", {}, "–"), make("span", { class: "of" }, word));
    button.addEventListener("click", () => {
      of("state", HTMLSelectElement).value = key;
      location.hash = "#table";
    });
    return button;
  });
  const button = make("button", { type: "button", class: "count", "data-group": "alarms" }, make("span", { class: "shape", "aria-hidden": "true" }, "!"), make("b", {}, "–"), make("span", { class: "of" }, "alarms not seen"));
  button.addEventListener("click", () => {
    location.hash = "#alarms";
  });
  byId("counts").append(button, ...parts);
}

function renderCounts() {
  const { counts } = plant;
  for (const part of byId("counts").children) {
    const key = /** @type {HTMLElement} */ (part).dataset.group ?? "";
    const number = counts && fresh ? (key === "alarms" ? counts.unacknowledged : counts[/** @type {keyof typeof counts} */ (key)]) : null;
    const box = part.querySelector("b");
    if (box) say(box, number === null ? "–" : String(number));
    part.classList.toggle("none", number === 0);
  }
}

function render() {
  due = null;
  renderCounts();
  if (view === "wall") wall.render(plant.sorted(), plant.now());
  if (view === "table") table.render(plant.sorted(), plant.now());
}

/** Draws soon, once for everything that comes until then. */
function soon() {
  if (due === null) due = setTimeout(render, TOGETHER_MS);
}

/** @type {ReturnType<typeof setTimeout> | null} */
let asking = null;

/** Asks anew for what is not in the stream, once for all news until then. */
function askSoon() {
  if (asking !== null) return;
  asking = setTimeout(() => {
    asking = null;
    if (view === "alarms") alarms.refresh();
    if (view === "motor") motor.refresh();
  }, TOGETHER_MS);
}

async function numbers() {
  if (document.hidden || !fresh) return;
  if (view === "alarms") alarms.refresh();
  if (view === "motor") motor.refresh();
  if (view !== "table") return;
  const { answer } = await ask("wall");
  if (!answer) return;
  plant.all(/** @type {import("./messages").Wall} */ (answer));
  render();
}

/** @param {boolean} heard */
function connection(heard) {
  const was = fresh;
  fresh = heard && trouble === "";
  if (fresh) since = new Date();
  document.body.classList.toggle("stale", !fresh);
  byId("connection").dataset.state = fresh ? "open" : "waiting";
  say(byId("connection"), fresh ? "connected" : trouble || `no connection since ${timeOfDay(since)}`);
  if (was !== fresh) render();
}

/** Shows the view of the address. */
function route() {
  const [name, id] = location.hash.slice(1).split("/");
  view = VIEWS.find((known) => known === name) ?? "wall";
  if (view === "motor" && !id) view = "wall";
  for (const known of VIEWS) {
    const [tab, panel] = [byId(`tab-${known}`), byId(`view-${known}`)];
    tab.setAttribute("aria-selected", String(known === view));
    tab.tabIndex = known === view ? 0 : -1;
    show(panel, known === view);
  }
  show(byId("tab-motor"), view === "motor");
  document.body.dataset.view = view;
  render();
  if (view === "table") numbers();
  if (view === "alarms") alarms.refresh();
  if (view === "models") models.refresh();
  if (view === "motor") motor.open(decodeURIComponent(id));
}

/** @param {KeyboardEvent} event */
function tabKey(event) {
  const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  if (!step) return;
  const tabs = VIEWS.filter((name) => !byId(`tab-${name}`).hidden);
  const next = tabs[(tabs.indexOf(view) + step + tabs.length) % tabs.length];
  if (next !== "motor") location.hash = `#${next}`;
  byId(`tab-${next}`).focus();
  event.preventDefault();
}

function start() {
  buildCounts();
  for (const name of VIEWS) {
    if (name !== "motor") byId(`tab-${name}`).addEventListener("click", () => (location.hash = `#${name}`));
  }
  byId("tabs").addEventListener("keydown", tabKey);
  byId("wall").addEventListener("keydown", wall.key);
  table.start(render);
  alarms.start(() => {
    alarms.refresh();
    if (view === "motor") motor.refresh();
  });
  account.start();
  models.start();
  addEventListener("hashchange", route);
  addEventListener("resize", soon);
  setInterval(numbers, NUMBERS_MS);
  // The age of what is stale.
  setInterval(() => view === "wall" && soon(), 1000);
  listen({
    wall: (all) => (plant.all(all), connection(true), soon(), askSoon()),
    news: (news) => (plant.news(news), soon(), askSoon()),
    alive: (alive) => {
      plant.clock(alive.now_ms);
      trouble = alive.trouble;
      connection(true);
    },
    heard: connection,
    refused: () => account.refresh(),
  });
  route();
}

start();
