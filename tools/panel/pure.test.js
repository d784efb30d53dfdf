// The pure functions of the panel's scripts.

import assert from "node:assert/strict";
import test from "node:test";

import { groups, named, none } from "../../crates/panel/assets/causes.js";
import { airy, decimals, following, symmetric } from "../../crates/panel/assets/charts.js";
import { switched } from "../../crates/panel/assets/controls.js";
import { lasting, likely, seen } from "../../crates/panel/assets/events.js";
import { answers, expected, isAsked } from "../../crates/panel/assets/first/plate.js";
import { clock, either, fixed, moment, percent, rpm, shown, timeOfDay } from "../../crates/panel/assets/format.js";
import { LIMIT_MS, Watch, stale } from "../../crates/panel/assets/freshness.js";
import { advice, headline } from "../../crates/panel/assets/lamps.js";
import { changed } from "../../crates/panel/assets/parameters.js";
import { Series, firstAfter } from "../../crates/panel/assets/series.js";
import { columnsOf } from "../../crates/panel/assets/workbench/columns.js";
import { inWords, sorted } from "../../crates/panel/assets/workbench/recordings.js";
import { worstOf } from "../../crates/panel/assets/workbench/regions.js";
import { adoptable } from "../../crates/panel/assets/workbench/results.js";
import { arrows, polar, tip } from "../../crates/panel/assets/vectors.js";

/** @typedef {import("../../crates/panel/assets/messages").WindowMessage} WindowMessage */
/** @typedef {import("../../crates/panel/assets/messages").Lamps} Lamps */
/** @typedef {import("../../crates/panel/assets/messages").Cause} Cause */

/** @type {Lamps} */
const DARK = { run: "on", r1: "off", r2: "off", r3: "off", r4: "off", sensor: "off", line: "off", load: "off", fault: "off" };

/** @type {import("../../crates/panel/assets/messages").Operation} */
const NOTHING = {
  voltage_rms_volt: null, current_rms_amp: null, frequency_hz: null, speed_rad_s: null, slip_percent: null, torque_nm: null, load_percent: null,
  current_unbalance_percent: null, voltage_unbalance_percent: null,
};

/**
 * @param {Partial<Lamps>} lamps
 * @param {Partial<WindowMessage>} [rest]
 * @returns {WindowMessage}
 */
const window = (lamps, rest = {}) => ({
  sequence: 1, t_s: 1, lamps: { ...DARK, ...lamps }, not_judged: null, motion: null, findings: [], r_percent: null, r_over_threshold: null,
  significance_sigma: null, resistance_rise_percent: null, causes: [], todo: [], operation: NOTHING, vectors: null, ...rest,
});

/**
 * @param {string} name
 * @param {number} probability_percent
 * @param {boolean} [tied]
 * @returns {Cause}
 */
const cause = (name, probability_percent, tied = false) => ({ name, words: name, phase: null, probability_percent, size_percent: null, tied });

test("numbers keep their digits and never show a minus zero", () => {
  assert.equal(shown(0.123456), "0.123");
  assert.equal(shown(-1234.5), "−1235");
  assert.equal(shown(0), "0.00");
  assert.equal(shown(12), "12.0");
  assert.equal(shown(-2e-7), "−2.00e−7");
  assert.equal(shown(null), "–");
  assert.equal(shown(NaN), "–");
  assert.equal(fixed(-0.001, 2), "0.00");
  assert.equal(fixed(-1.5, 1), "−1.5");
  assert.equal(percent(99.7), "> 99 %");
  assert.equal(percent(100), "100 %");
  assert.equal(clock(7.5), "7.50 s");
  assert.equal(clock(125), "2:05.0");
  assert.equal(either(["a"]), "a");
  assert.equal(either(["a", "b", "c"]), "a, b or c");
});

test("a series forgets the oldest, breaks at gaps and begins anew when the clock goes back", () => {
  const series = new Series(["x"], 100);
  for (let k = 0; k < 1000; k += 1) series.push(k * 0.02, [k]);
  assert.ok(series.t.length >= 100 && series.t.length <= 125, String(series.t.length));
  assert.equal(series.columns[0].at(-1), 999);
  series.push(30, [1]);
  assert.deepEqual(series.columns[0].slice(-3), [999, null, 1]);
  series.push(1, [5]);
  assert.deepEqual(series.t, [1]);
});

test("a chart gets the last seconds of the columns it names", () => {
  const series = new Series(["x", "y"], 100);
  for (let k = 0; k <= 10; k += 1) series.push(k * 0.1, [k, k === 9 ? null : -k]);
  const [t, y] = series.last(0.25, ["y"]);
  assert.deepEqual(t.map((x) => Math.round(10 * x)), [8, 9, 10]);
  assert.deepEqual(y, [-8, null, -10]);
  assert.equal(firstAfter([1, 2, 3], 2), 1);
  assert.equal(firstAfter([], 2), 0);
});

test("the advice is about the causes that the headline names", () => {
  const bars = headline(window({ fault: "on" }, { causes: [cause("bars", 100)], todo: ["record at another load"] }));
  assert.deepEqual([bars.why, bars.todo], ["Likeliest: bars.", "Record at another load."]);
  const heat = advice(window({ fault: "on", r1: "on", r4: "on" }, { todo: ["first heat: is it hot?", "measure it"] }));
  assert.equal(heat, "First heat: is it hot? Measure it.");
  assert.equal(advice(window({ fault: "on" })), "");
});

test("the headline says the worst first, and each thing once", () => {
  assert.equal(headline(window({})).mood, "good");
  assert.deepEqual(headline(window({ run: "blink" }, { not_judged: "transient" })), { mood: "waiting", title: "Not judged", why: "Transient.", todo: "" });
  const tied = window({ fault: "on", r1: "on", r4: "on", line: "on" }, { causes: [cause("Rs", 48, true), cause("Rr", 48, true), cause("unknown", 3)] });
  assert.equal(headline(tied).why, "Likeliest: Rs or Rr.");
  const dead = { findings: ["current sensor a is dead"], not_judged: "current sensor a is dead" };
  for (const causes of [[], [{ ...cause("Iq", 100), phase: "a" }]]) {
    const { title, why, todo } = headline(window({ run: "blink", fault: "on", sensor: "on" }, { ...dead, causes }));
    assert.deepEqual([title, why, todo], ["Fault", "Current sensor a is dead.", "Check the sensor's cable and its supply."]);
  }
  assert.equal(headline(window({ run: "off", line: "on" }, { not_judged: "no supply" })).todo, "Check fuse and contactor.");
  assert.equal(headline(window({ load: "on" })).title, "Overload");
});

test("causes that are tied with the likeliest stand together, others alone", () => {
  const found = groups([cause("a", 40, true), cause("b", 40, true), cause("c", 10), cause("d", 10)]);
  assert.deepEqual(found.map((group) => group.map((one) => one.name)), [["a", "b"], ["c"], ["d"]]);
  assert.deepEqual(groups([cause("a", 90), cause("b", 5)]).length, 2);
  assert.equal(named({ ...cause("turns", 90), words: "shorted turns", phase: "b", size_percent: 4.4 }), "shorted turns, phase b +4 %");
});

test("no cause: FAULT is dark, or this window does not tell", () => {
  assert.equal(none(window({})), "FAULT is dark: nothing to explain.");
  assert.ok(none(window({ fault: "on" })).startsWith("FAULT is lit;"));
});

test("two seconds after the last window, or the last word, nothing holds any more", () => {
  const heard = { window: 1000, word: 1000, rests: false, speed: 1 };
  assert.equal(stale(heard, 1000 + LIMIT_MS), false);
  assert.equal(stale(heard, 1001 + LIMIT_MS), true);
  // A server that lives and brings no window is stale too, unless its source rests.
  assert.equal(stale({ ...heard, word: 5000 }, 5000), true);
  assert.equal(stale({ ...heard, word: 5000, rests: true }, 5000), false);
  assert.equal(stale({ ...heard, rests: true }, 5000), true);
  // At a hundredth of real time a window takes two seconds.
  assert.equal(stale({ ...heard, word: 5000, speed: 0.01 }, 5000), false);
});

test("a source that rested has time for its next window", () => {
  let now = 0;
  const watch = new Watch(() => now);
  watch.alive(true);
  now = 60_000;
  watch.alive(true);
  assert.equal(watch.stale(), false);
  now += 1000;
  watch.alive(false);
  now += LIMIT_MS;
  assert.equal(watch.stale(), false);
  watch.alive(false);
  now += 1;
  assert.equal(watch.stale(), true);
  watch.window();
  assert.equal(watch.stale(), false);
});

test("times of day and turns", () => {
  assert.equal(timeOfDay(new Date(2026, 0, 2, 3, 4, 5)), "03:04:05");
  const when = new Date(2026, 0, 2, 3, 4, 5).getTime() / 1000;
  assert.equal(moment(when, new Date(2026, 0, 2)), "03:04:05");
  assert.equal(moment(when, new Date(2026, 0, 3)), "2026-01-02 03:04:05");
  assert.equal(Math.round(rpm(157.0796)), 1500);
});

test("a switch changes its own fault and no other", () => {
  const on = switched([{ name: "Rs", change_percent: 50 }], "Bl", true, -20);
  assert.deepEqual(on, [{ name: "Rs", change_percent: 50 }, { name: "Bl", change_percent: -20 }]);
  assert.deepEqual(switched(on, "Rs", true, 10)[1], { name: "Rs", change_percent: 10 });
  assert.deepEqual(switched(on, "Rs", false, 0), [{ name: "Bl", change_percent: -20 }]);
});

test("only what was changed is sent", () => {
  const fields = [{ key: "p.a", value: "8.0" }, { key: "p.b", value: "" }].map((field) => ({ ...field, label: "", symbol: "", unit: "" }));
  assert.deepEqual(changed(fields, { "p.a": " 8 ", "p.b": "" }), {});
  assert.deepEqual(changed(fields, { "p.a": "-8", "p.b": "2" }), { "p.a": "-8", "p.b": "2" });
  assert.deepEqual(changed(fields, { "p.a": "" }), { "p.a": "" });
});

test("events say what, and for how long", () => {
  const event = { id: 0, t_s: 1, cleared_s: null, unix_s: 0, lit: [], causes: [cause("Rs", 48, true), cause("Rr", 48, true)], findings: [], acknowledged: null, samples: 0 };
  assert.equal(likely(event), "Rs or Rr");
  assert.equal(likely({ ...event, findings: ["no supply"] }), "no supply");
  assert.equal(lasting(event), "lit now");
  assert.equal(lasting({ ...event, cleared_s: 2.5 }), "1.50 s");
  const day = new Date(2026, 0, 2, 3, 4, 5);
  const acknowledged = { by: "Ada", unix_s: day.getTime() / 1000, comment: "joint tightened" };
  assert.equal(seen({ ...event, acknowledged }, day), "Ada, 03:04:05: joint tightened");
  assert.equal(seen({ ...event, acknowledged: { ...acknowledged, by: "", comment: "" } }, day), "somebody, 03:04:05");
  assert.equal(seen(event), "–");
});

test("axes keep the threshold in sight and noise small", () => {
  assert.ok(symmetric(0.1, 0.2)[1] > 1 && symmetric(0.1, 0.2)[0] < -1);
  assert.ok(symmetric(-50, 2)[0] < -50);
  const [low, high] = airy(100, 100.1, false);
  assert.ok(low < 99 && high > 101);
  assert.equal(airy(2.5, 2.6, true)[0], 0);
  assert.ok(airy(-2, 3, true)[0] < -2);
});

test("arrows: d to the right, q upwards, rated voltage at the rim, never far beyond", () => {
  const vectors = { frame: /** @type {const} */ ("rotor-flux"), u_dq_volt: /** @type {[number, number]} */ ([0, 325]), i_dq_amp: /** @type {[number, number]} */ ([70, 0]), psi_r_dq_volt_second: /** @type {[number, number]} */ ([1, 0]) };
  const [voltage, current, flux] = arrows(vectors, [325, 7], 314);
  assert.deepEqual(tip(voltage).map(Math.round), [0, -86]);
  assert.ok(tip(current)[0] > 86 && tip(current)[0] < 100);
  assert.ok(Math.abs(tip(flux)[0] - 0.86 * 86 * 314 / 325) < 0.1);
  assert.equal(Math.round(polar([3, 4]).degrees), 53);
  assert.deepEqual(tip({ dq: [0, 0], full: 1, share: 1 }), [0, 0]);
});

test("ticks have as many digits as they need", () => {
  assert.deepEqual([50, 1, 0.5, 0.25, 0.1, 0.02].map(decimals), [0, 0, 1, 2, 1, 2]);
});

test("a time axis fills from the left, then follows", () => {
  assert.deepEqual(following(2, 3, 10), { min: 2, max: 12 });
  assert.deepEqual(following(2, 30, 10), { min: 20, max: 30 });
});

test("a form of columns says what was said and nothing else", () => {
  const form = new FormData();
  for (const [name, value] of [["column-ia", " I1 "], ["unit-ia", "mA"], ["column-ib", ""], ["delimiter", ";"], ["decimal_comma", "on"], ["sample_rate_hz", "5000"]]) form.append(name, value);
  const columns = columnsOf(form);
  assert.deepEqual([columns.column, columns.unit, columns.scale], [{ ia: "I1" }, { ia: "mA" }, {}]);
  const wrong = new FormData();
  wrong.append("sample_rate_hz", "many");
  assert.throws(() => columnsOf(wrong), /"many" is no number/);
  assert.deepEqual([columns.delimiter, columns.decimal_comma, columns.line_voltages, columns.sample_rate_hz, columns.pulses_per_revolution], [";", true, false, 5000, null]);
});

test("a sidecar is told from its recording by its name", () => {
  const files = [{ name: "x.TOML" }, { name: "x.csv.gz" }];
  assert.deepEqual(sorted(files), { recording: files[1], sidecar: files[0] });
  assert.deepEqual(sorted([files[0]]), { recording: undefined, sidecar: files[0] });
  assert.equal(inWords({ kind: "recording", samples: 5000, sample_rate_hz: 5000, duration_s: 1, channels: ["ia", "ib"], notes: [] }), "1.00 s at 5.00 kHz: ia, ib");
});

test("what was found is offered first, and each name once", () => {
  const result = { overlay: null, next: { adopt: "core-loss" }, steps: [{ effect: "core-loss", tied_with: ["windage", "stator resistance"] }], ranking: [{ effect: "windage" }, { effect: "skin-effect" }] };
  assert.deepEqual(adoptable(result), ["core-loss", "windage", "skin-effect"]);
});

test("a band opens at the block of it that is furthest off", () => {
  const block = (/** @type {number} */ t, /** @type {number} */ load_percent, /** @type {number} */ error) => ({ t, load_percent, voltage_percent: 100, slip_percent: null, frequency_hz: 25, current_error_amp: [error] });
  const result = { overlay: { close: { t: [], signals: [] }, blocks: [block(1, 50, 2), block(2, -60, 3), block(3, 90, 9)] } };
  const found = worstOf(result, { quantity: "load", from_percent: 50, to_percent: 75 }, 50);
  assert.ok(found && Math.abs(found.from_s - 1.94) < 1e-9 && Math.abs(found.to_s - 2.06) < 1e-9);
  assert.equal(worstOf(result, { quantity: "slip", from_percent: 0, to_percent: 5 }, 50), null);
  assert.equal(worstOf(result, { quantity: "frequency", from_percent: 50, to_percent: 75 }, 50)?.from_s, 3 - 0.06);
});

/**
 * @param {string} key
 * @param {"every" | "iec" | "nema" | "elsewhere"} on
 */
const question = (key, on) => ({ key, words: key, unit: "", range: "", missing: "", on });

test("a plate is asked for what its kind prints, and empty answers are not sent", () => {
  const questions = [question("power_kw", "iec"), question("power_hp", "nema"), question("speed_rpm", "every"), question("name", "elsewhere")];
  assert.deepEqual(questions.filter((each) => isAsked(each, "nema")).map(({ key }) => key), ["power_hp", "speed_rpm", "name"]);
  const typed = /** @type {Record<string, string>} */ ({ power_kw: "5.5", power_hp: "7.5", speed_rpm: "  ", name: " Pump " });
  assert.deepEqual(answers(questions, "iec", (key) => typed[key]), { power_kw: "5.5", name: "Pump" });
  assert.deepEqual(answers(questions, "nema", (key) => typed[key]), { power_hp: "7.5", name: "Pump" });
});

test("a number that is not printed is told as expected", () => {
  const plate = [{ name: "power_factor", printed: null, circuit: 0.681, low: 0.621, high: 0.746 }, { name: "speed_rpm", printed: 1725, circuit: 1727, low: 1723, high: 1732 }];
  assert.equal(expected("power_factor", plate), "expected: 0.681 (95 %: 0.621 to 0.746)");
  assert.equal(expected("speed_rpm", plate), "");
  assert.equal(expected("inertia_kg_m2", plate), "");
});
