// Conditions, alarms and times in words and shapes: never in colour alone.

/** @typedef {import("./messages").Condition} Condition */
/** @typedef {import("./messages").Tile} Tile */
/** @typedef {import("./messages").AlarmState} AlarmState */

/** @type {Record<Condition, [string, string]>} shape and word */
export const CONDITIONS = {
  fault: ["▲", "Fault"], sensor: ["◆", "Sensor"], supply: ["◆", "Supply"], overload: ["◆", "Overload"],
  stale: ["?", "No data"], never: ["?", "No data yet"], not_judged: ["◐", "Not judged"], off: ["○", "Off"], healthy: ["✓", "Healthy"],
};

/** @type {Record<AlarmState, string>} */
export const STATES = {
  normal: "over", unacknowledged: "new", acknowledged: "seen", returned_unacknowledged: "gone, not seen", shelved: "shelved", suppressed: "suppressed",
};

/** Names of the lamps in their order. */
export const LAMPS = ["RUN", "r1", "r2", "r3", "r4", "SENSOR", "LINE", "LOAD", "FAULT"];

/** From this rank on nobody has to do anything about a motor (crates/panel/src/fleet/wall.rs). */
const FROM_STALE = 9;

/**
 * Whether a motor is shown large.
 * @param {Pick<Tile, "rank">} tile
 */
export const urgent = ({ rank }) => rank < FROM_STALE;

/**
 * Group of the count line that a condition belongs to.
 * @param {Condition} condition
 */
export function group(condition) {
  if (condition === "sensor" || condition === "supply" || condition === "overload") return "attention";
  return condition === "never" ? "stale" : condition;
}

/**
 * How old something is, in one or two units.
 * @param {number} ms
 * @returns {string}
 */
export function age(ms) {
  const s = Math.max(0, Math.floor(ms / 1000));
  if (s < 60) return `${s} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min`;
  if (s < 86400) return `${Math.floor(s / 3600)} h ${Math.floor((s % 3600) / 60)} min`;
  return `${Math.floor(s / 86400)} d ${Math.floor((s % 86400) / 3600)} h`;
}

/**
 * The news of a tile in a line.
 * @param {Tile} tile
 * @returns {string}
 */
export function news(tile) {
  const { alarm, condition, words } = tile;
  if (condition === "fault") return words;
  // What is over or unknown is not told as if it were now.
  if (alarm && urgent(tile)) return alarm.words;
  return words;
}

/**
 * What its alarm waits for, in a word; empty without one.
 * @param {Tile} tile
 */
export const mark = ({ alarm }) => (alarm ? STATES[alarm.state] : "");

/**
 * Everything about a tile, for who does not see it.
 * @param {Tile} tile
 * @param {number} now_ms
 */
export function spoken(tile, now_ms) {
  const [, word] = CONDITIONS[tile.condition];
  const old = tile.condition === "stale" && tile.last ? `for ${age(now_ms - tile.last.time_ms)}` : "";
  const alarm = tile.alarm ? `alarm ${tile.alarm.number} ${mark(tile)}: ${tile.alarm.words}` : "";
  return [tile.title, [word, old].filter(Boolean).join(" "), tile.words, alarm, tile.place].filter(Boolean).join(", ");
}
