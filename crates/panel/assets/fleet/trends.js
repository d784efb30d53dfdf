// Charts of a motor's history: residuals, voltage, current, speed, and its lamps as a band.

import { Chart, colour } from "../charts.js";
import { make } from "../dom.js";
import { moment } from "../format.js";
import { LAMPS } from "./words.js";

/** @typedef {import("./messages").Trend} Trend */
/** @typedef {import("./messages").Band} Band */
/** @typedef {import("../charts.js").Data} Data */

/** Lamps of the band from top to bottom, as bits of their place; RUN is told by gaps. */
const ROWS = [8, 5, 6, 7, 1, 2, 3, 4];

/**
 * Points with an empty one behind every gap: no line is drawn over what is not known.
 * @param {number[]} time_ms
 * @param {number} step_ms
 * @returns {(number | null)[]} places in the trend, `null` for a gap
 */
export function withGaps(time_ms, step_ms) {
  /** @type {(number | null)[]} */
  const places = [];
  time_ms.forEach((t, k) => {
    if (k > 0 && t - time_ms[k - 1] > 1.5 * step_ms) places.push(null);
    places.push(k);
  });
  return places;
}

/**
 * Least and largest over several bands.
 * @param {Band[]} bands
 * @param {number} k
 * @returns {[number | null, number | null]}
 */
export function reach(bands, k) {
  const known = (/** @type {(number | null)[]} */ values) => /** @type {number[]} */ (values.filter((value) => value !== null));
  const [least, most] = [known(bands.map((band) => band.min[k])), known(bands.map((band) => band.max[k]))];
  return [least.length > 0 ? Math.min(...least) : null, most.length > 0 ? Math.max(...most) : null];
}

/** The charts in a box. */
export class Trends {
  /** @param {HTMLElement} box */
  constructor(box) {
    const edges = [{ label: "least", color: "grey", dash: [2, 3] }, { label: "largest", color: "grey", dash: [2, 3] }];
    const chart = (/** @type {string} */ id, /** @type {string} */ title, /** @type {string} */ unit, /** @type {import("../charts.js").Line[]} */ lines, /** @type {object} */ more = {}) => {
      const place = make("div", {});
      box.append(place);
      return new Chart(place, { id, title, x: "time", unit, time: true, filled: true, lines: [...edges, ...lines], ...more });
    };
    const four = ["blue", "vermillion", "green", "purple"].map((color, k) => ({ label: `r${k + 1}`, color, dash: [[], [9, 4], [2, 3], [12, 3, 2, 3]][k] }));
    this.residuals = chart("residuals", "Residuals, mean and reach", "% of scale", four, { rows: 15 });
    this.band = make("canvas", { class: "lamp-band", role: "img" });
    box.append(make("figure", { class: "live" }, make("figcaption", {}, make("h3", {}, "Lamps")), this.band));
    this.voltage = chart("voltage", "Voltage", "V RMS", [{ label: "mean", color: "blue" }], { rows: 9 });
    this.current = chart("current", "Current", "A RMS", [{ label: "mean", color: "green" }], { rows: 9, zero: true });
    this.speed = chart("speed", "Speed", "1/min", [{ label: "mean", color: "purple" }], { rows: 9, zero: true });
    /** @type {{ trend: Trend, from: number, to: number } | null} */
    this.last = null;
    new ResizeObserver(() => this.lamps()).observe(this.band);
  }

  /**
   * @param {Trend} trend
   * @param {number} from_ms
   * @param {number} to_ms
   */
  show(trend, from_ms, to_ms) {
    this.last = { trend, from: from_ms, to: to_ms };
    const places = withGaps(trend.time_ms, trend.step_ms);
    const time = places.map((k, place) => (k === null ? (trend.time_ms[/** @type {number} */ (places[place - 1])] + trend.step_ms) / 1000 : trend.time_ms[k] / 1000));
    const column = (/** @type {(k: number) => number | null} */ of) => places.map((k) => (k === null ? null : of(k)));
    /** @param {Band[]} bands */
    const data = (bands) => /** @type {Data} */ ([time, column((k) => reach(bands, k)[0]), column((k) => reach(bands, k)[1]), ...bands.map((band) => column((k) => band.mean[k]))]);
    const range = { min: from_ms / 1000, max: to_ms / 1000 };
    this.residuals.update(data(trend.residuals_percent), 0, range);
    this.voltage.update(data([trend.voltage_v]), 0, range);
    this.current.update(data([trend.current_a]), 0, range);
    this.speed.update(data([trend.speed_rpm]), 0, range);
    this.lamps();
  }

  /** Draws the lamps: a row each, filled where it was lit. */
  lamps() {
    const { band, last } = this;
    const [width, height] = [Math.round(band.clientWidth * devicePixelRatio), Math.round(band.clientHeight * devicePixelRatio)];
    const context = band.getContext("2d");
    if (!context || !last || width === 0) return;
    [band.width, band.height] = [width, height];
    const rem = parseFloat(getComputedStyle(document.documentElement).fontSize) * devicePixelRatio;
    const [left, row] = [4.9 * rem, height / ROWS.length];
    const { trend, from, to } = last;
    const x = (/** @type {number} */ t) => left + ((width - left) * (t - from)) / (to - from);
    context.font = `${Math.min(0.8 * rem, 0.8 * row)}px system-ui, sans-serif`;
    context.textBaseline = "middle";
    ROWS.forEach((lamp, k) => {
      context.fillStyle = colour("ink-2");
      context.fillText(LAMPS[lamp], 0, (k + 0.5) * row);
      context.fillStyle = colour("surface");
      context.fillRect(left, k * row + 1, width - left, row - 2);
      trend.time_ms.forEach((t, at) => {
        const state = (trend.lamps[at] >>> (2 * lamp)) & 3;
        if (state === 0) return;
        context.fillStyle = colour(lamp === 8 ? "vermillion" : "orange");
        // Blinking is waiting: half as high.
        const share = state === 1 ? 1 : 0.4;
        context.fillRect(x(t), k * row + 1, Math.max(1, x(t + trend.step_ms) - x(t)), (row - 2) * share);
      });
    });
    const lit = ROWS.filter((lamp) => trend.lamps.some((bits) => ((bits >>> (2 * lamp)) & 3) === 1)).map((lamp) => LAMPS[lamp]);
    band.setAttribute("aria-label", `Lamps from ${moment(from / 1000)} to ${moment(to / 1000)}: ${lit.length > 0 ? `${lit.join(", ")} lit` : "none lit"}`);
  }
}
