// The pure functions of the fleet page's scripts.

import assert from "node:assert/strict";
import test from "node:test";

import { instant } from "../../crates/panel/assets/charts.js";
import { actions } from "../../crates/panel/assets/fleet/alarms.js";
import { wanted, when } from "../../crates/panel/assets/fleet/models.js";
import { order } from "../../crates/panel/assets/fleet/plant.js";
import { compared, matches } from "../../crates/panel/assets/fleet/table.js";
import { reach, withGaps } from "../../crates/panel/assets/fleet/trends.js";
import { layout, rows } from "../../crates/panel/assets/fleet/wall.js";
import { age, group, mark, news, spoken, urgent } from "../../crates/panel/assets/fleet/words.js";

/** @typedef {import("../../crates/panel/assets/fleet/messages").Tile} Tile */

const NOW = 1_790_000_000_000;

/**
 * @param {string} id
 * @param {Partial<Tile>} [rest]
 * @returns {Tile}
 */
const tile = (id, rest = {}) => ({ id, title: id, place: "", rank: 14, condition: "healthy", words: "", alarm: null, open_alarms: 0, last: null, ...rest });

/** @type {Tile["alarm"]} */
const NEW = { number: 7, state: "unacknowledged", severity: "high", words: "fault: rotor", raised_ms: NOW };

test("the worst is first, of equals what rose last, then the name", () => {
  const tiles = [tile("b"), tile("a"), tile("old", { rank: 0, alarm: { ...NEW, raised_ms: 1 } }), tile("new", { rank: 0, alarm: NEW })];
  assert.deepEqual(tiles.sort(order).map(({ id }) => id), ["new", "old", "a", "b"]);
});

test("a search wants every word, a state its group", () => {
  const pump = tile("pump-7", { title: "Feed pump", place: "Hall 1", condition: "supply", open_alarms: 1 });
  assert.ok(matches(pump, "", "hall PUMP") && matches(pump, "attention", "") && matches(pump, "alarm", "feed"));
  assert.ok(!matches(pump, "", "hall 2") && !matches(pump, "fault", "") && !matches(tile("a"), "alarm", ""));
});

test("what is not known is last in both directions", () => {
  const sorted = (/** @type {boolean} */ down) => [2, null, 10, 1].sort((a, b) => compared(a, b, down));
  assert.deepEqual(sorted(false), [1, 2, 10, null]);
  assert.deepEqual(sorted(true), [10, 2, 1, null]);
  assert.ok(compared("m2", "m10", false) < 0);
});

test("ages have one or two units", () => {
  assert.deepEqual([-5, 59_999, 60_000, 7_260_000, 90_000_000].map(age), ["0 s", "59 s", "1 min", "2 h 1 min", "1 d 1 h"]);
});

test("what is over or old is not told as if it were now", () => {
  const old = tile("a", { condition: "stale", rank: 0, words: "no answer", alarm: NEW, last: null });
  assert.equal(news(old), "fault: rotor");
  assert.equal(mark(old), "new");
  assert.match(spoken(old, NOW), /^a, No data, no answer, alarm 7 new: fault: rotor$/);
  assert.ok(urgent(old) && !urgent(tile("a", { rank: 9 })));
  assert.deepEqual(["sensor", "never", "off"].map((condition) => group(/** @type {Tile["condition"]} */ (condition))), ["attention", "stale", "off"]);
});

test("rows of a grid that is filled row by row", () => {
  assert.equal(rows(10, 1, 0, 95), 10);
  // Two large tiles of 3 abreast leave 12 cells beside them.
  assert.equal(rows(10, 3, 2, 12), 3);
  assert.equal(rows(10, 3, 2, 13), 4);
  assert.equal(rows(10, 3, 4, 0), 6);
  assert.equal(rows(2, 3, 1, 5), Infinity);
});

test("everything fits, and what is urgent is as large as it may be", () => {
  for (const [width, height] of [[1256, 650], [3800, 2000], [360, 700]]) {
    for (const large of [0, 1, 3, 12, 80, 300]) {
      const { columns, span, height: cell } = layout(width, height, large, 300 - large);
      if (width > 1000) assert.ok(rows(columns, span, large, 300 - large) * cell <= height, `${width} ${large}`);
      assert.ok(span >= 1 && cell >= 26, `${width} ${large}`);
      if (width > 1000 && large > 0 && large <= 12) assert.ok(span >= 2, `${width} ${large}: ${span}`);
    }
  }
  assert.ok(layout(3800, 2000, 3, 297).height * layout(3800, 2000, 3, 297).span > 300);
});

test("no line is drawn over a gap", () => {
  assert.deepEqual(withGaps([0, 10, 20, 50, 60], 10), [0, 1, 2, null, 3, 4]);
  assert.deepEqual(withGaps([], 10), []);
  const band = { min: [-2, null], mean: [0, null], max: [1, null] };
  assert.deepEqual(reach([band, { ...band, max: [5, null] }], 0), [-2, 5]);
  assert.deepEqual(reach([band], 1), [null, null]);
});

test("what a person can do depends on the alarm", () => {
  assert.deepEqual(actions({ state: "unacknowledged" }), ["acknowledge", "shelve"]);
  assert.deepEqual(actions({ state: "returned_unacknowledged" }), ["acknowledge", "shelve"]);
  assert.deepEqual(actions({ state: "acknowledged" }), ["shelve"]);
  assert.deepEqual(actions({ state: "shelved" }), ["unshelve"]);
  assert.deepEqual(actions({ state: "normal" }), []);
});

test("an axis of time has times, and dates where days begin", () => {
  const at = new Date(2026, 10, 26, 9, 5, 7);
  assert.deepEqual([10, 60, 86_400, 30 * 86_400].map((step) => instant(at, step)), ["09:05:07", "09:05", "11-26", "2026-11"]);
  assert.equal(instant(new Date(2026, 10, 26), 3600), "11-26");
});

/**
 * @param {Partial<import("../../crates/panel/assets/fleet/messages").Model>} rest
 * @returns {import("../../crates/panel/assets/fleet/messages").Model}
 */
const model = (rest) => ({ id: "pump-7", title: "Feed pump", place: "Hall 1", file: "pump.toml", name: "7.5 kW", effects: ["core-loss"], calibrated: true, file_constants: "1", board_constants: null, learnt: null, calibrated_ms: NOW, calibrated_on: "2026-09-21", calibrated_by: "file", due_ms: NOW + 86_400_000, drift_percent: null, due: false, why: "", ...rest });

test("a filter shows what is due, a search looks at file and effects", () => {
  assert.ok(wanted(model({}), false, "core PUMP.toml") && wanted(model({ due: true }), true, ""));
  assert.ok(!wanted(model({}), true, "") && !wanted(model({}), false, "saturation"));
});

test("a due date is told, and what is not known is called so", () => {
  assert.equal(when(model({}), NOW), "in 1 d");
  assert.equal(when(model({ due: true }), NOW), "due");
  assert.equal(when(model({ due_ms: null }), NOW), "not known");
});
