// Charts that follow the source: drag to zoom, double-click or "Follow" to go on, cursor read-out, keyboard, PNG.

import { make, show } from "./dom.js";
import { fixed, moment, shown } from "./format.js";

/**
 * @typedef {object} Line
 * @property {string} label
 * @property {string} color name of a colour of report.css
 * @property {number[]} [dash]
 */

/**
 * @typedef {object} Spec
 * @property {string} id file name of the PNG
 * @property {string} title
 * @property {string} x label of the time axis
 * @property {string} unit of the values
 * @property {Line[]} lines
 * @property {number} [limit] both signs of it are drawn, with the band between
 * @property {boolean} [asinh] small values linear, large ones logarithmic
 * @property {boolean} [zero] zero is always in sight
 * @property {number} [rows] height in rem
 * @property {boolean} [time] x is the time of day, Unix seconds
 * @property {boolean} [filled] between the first two lines
 */

/** @typedef {[number[], ...(number | null)[][]]} Data */

/** Ticks of an axis that is linear below 1 and logarithmic above. */
const POWERS = [-100, -10, -3, -1, 0, 1, 3, 10, 100];
/** Title and legend above a saved chart, in lines of text. */
const PNG_LINES = 2.6;

const rem = () => parseFloat(getComputedStyle(document.documentElement).fontSize);

/**
 * A colour of the style sheet, as it is now: light or dark.
 * @param {string} name
 */
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/**
 * Range of a symmetric axis: at least the limit, with some air.
 * @param {number | null} least
 * @param {number | null} most
 * @returns {[number, number]}
 */
export function symmetric(least, most) {
  const reach = 1.35 * Math.max(Math.abs(least ?? 0), Math.abs(most ?? 0), 1.6);
  return [-reach, reach];
}

/**
 * Range of a linear axis: never so narrow that noise fills it.
 * @param {number | null} least
 * @param {number | null} most
 * @param {boolean} zero
 * @returns {[number, number]}
 */
export function airy(least, most, zero) {
  let [low, high] = [least ?? 0, most ?? 1];
  if (zero) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
  const middle = (low + high) / 2;
  const half = Math.max(0.55 * (high - low), 0.02 * Math.abs(middle), 0.05);
  if (zero && low === 0) return [0, middle + half];
  return [middle - half, middle + half];
}

/**
 * The part of the time axis in sight: it fills from the left, then follows the newest value.
 * @param {number} first
 * @param {number} last
 * @param {number} span seconds
 */
export function following(first, last, span) {
  const max = Math.max(last, first + span);
  return { min: max - span, max };
}

/**
 * Digits behind the point that ticks of this distance need.
 * @param {number} step
 */
export function decimals(step) {
  let digits = 0;
  while (digits < 6 && Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-6) digits += 1;
  return digits;
}

/**
 * An instant on a time axis whose ticks are so far apart: the time, or the date where a day begins.
 * @param {Date} at
 * @param {number} step seconds
 */
export function instant(at, step) {
  const two = (/** @type {number} */ number) => String(number).padStart(2, "0");
  const date = `${two(at.getMonth() + 1)}-${two(at.getDate())}`;
  if (step >= 28 * 86_400) return `${at.getFullYear()}-${two(at.getMonth() + 1)}`;
  if (step >= 86_400 || (at.getHours() === 0 && at.getMinutes() === 0 && at.getSeconds() === 0)) return date;
  const time = `${two(at.getHours())}:${two(at.getMinutes())}`;
  return step < 60 ? `${time}:${two(at.getSeconds())}` : time;
}

/** One chart in a box. */
export class Chart {
  /**
   * @param {HTMLElement} box
   * @param {Spec} spec
   */
  constructor(box, spec) {
    this.spec = spec;
    /** @type {Data} */
    this.data = [[], ...spec.lines.map(() => [])];
    this.held = false;
    this.span = 0;
    /** @type {{ min: number, max: number } | null} */
    this.fixed = null;
    this.plotBox = make("div", { class: "plot", tabindex: 0, role: "group", "aria-label": `${spec.title}: arrow keys read out, plus and minus zoom, Escape follows` });
    this.follow = make("button", { type: "button", class: "follow", hidden: true }, "Follow");
    const save = make("button", { type: "button", title: `save ${spec.title} as an image` }, "PNG");
    const caption = make("figcaption", {}, make("h3", {}, spec.title), make("span", { class: "tools" }, this.follow, save));
    box.append(make("figure", { class: "live" }, caption, this.plotBox));
    this.follow.addEventListener("click", () => this.release());
    save.addEventListener("click", () => this.save());
    this.plotBox.addEventListener("keydown", (event) => this.key(event));
    this.plot = this.build();
    new ResizeObserver(() => requestAnimationFrame(() => this.fit())).observe(this.plotBox);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.rebuild());
    // Another screen, another ratio: canvas, lines and text are measured anew.
    addEventListener("dppxchange", () => requestAnimationFrame(() => this.rebuild()));
  }

  size() {
    return { width: Math.max(180, this.plotBox.clientWidth), height: Math.round((this.spec.rows ?? 13) * rem()) };
  }

  fit() {
    const size = this.size();
    // Another height means another size of text.
    if (size.height !== this.plot.height) this.rebuild();
    else if (size.width !== this.plot.width) this.plot.setSize(size);
  }

  rebuild() {
    this.plot.destroy();
    this.plot = this.build();
  }

  build() {
    const { spec } = this;
    // uPlot multiplies a whole number of pixels by the pixel ratio; of a fraction it takes the digits behind the point.
    const font = `${Math.round(0.8 * rem())}px system-ui, sans-serif`;
    const axis = { stroke: colour("ink-2"), font, labelFont: font, labelGap: 2, grid: { stroke: colour("rule"), width: 1 }, ticks: { stroke: colour("rule"), width: 1, size: 4 } };
    /** @type {uPlot.Axis.DynamicValues} */
    const ticks = (_, values, _axis, _space, step) => values.map((value) => (value == null ? "" : fixed(value, decimals(step))));
    /** @type {uPlot.Axis.DynamicValues} */
    const times = (_, values, _axis, _space, step) => values.map((value) => (value == null ? "" : instant(new Date(1000 * value), step)));
    /** @type {uPlot.Axis.DynamicValues} */
    const powers = (_, values) => values.map((value) => (POWERS.includes(value) ? fixed(value, 0) : ""));
    /** @type {uPlot.Options} */
    const options = {
      ...this.size(),
      scales: { x: { time: spec.time ?? false, auto: false }, y: this.scale() },
      series: [{ label: spec.x, value: (_, value) => (spec.time ? moment(value) : shown(value, 5)) }, ...this.lines()],
      axes: [{ ...axis, size: 1.9 * rem(), space: 4.8 * rem(), values: spec.time ? times : ticks }, { ...axis, label: spec.unit, labelSize: 1.5 * rem(), size: 3.4 * rem(), values: spec.asinh ? powers : ticks, ...(spec.asinh ? { filter: (_, values) => values, splits: (u) => POWERS.filter((power) => power >= (u.scales.y.min ?? 0) && power <= (u.scales.y.max ?? 0)) } : {}) }],
      bands: this.bands(),
      cursor: { drag: { x: true, y: false }, sync: { key: spec.x } },
      legend: { live: true },
      hooks: { setSelect: [(u) => u.select.width > 0 && this.hold()] },
    };
    const plot = new uPlot(options, this.table(), this.plotBox);
    // Double-click shows everything in most charts; here it follows again.
    plot.over.addEventListener("dblclick", () => this.release());
    this.range(plot);
    return plot;
  }

  /** @returns {uPlot.Band[]} */
  bands() {
    const { limit, lines, filled } = this.spec;
    if (filled) return [{ series: [2, 1], fill: colour("rule") }];
    return limit ? [{ series: [lines.length + 1, lines.length + 2], fill: colour("inside") }] : [];
  }

  /** @returns {uPlot.Scale} */
  scale() {
    const { spec } = this;
    if (spec.asinh) return { distr: 4, asinh: 1, range: (_, least, most) => symmetric(least, most) };
    return { range: (_, least, most) => airy(least, most, spec.zero ?? false) };
  }

  /** @returns {uPlot.Series[]} */
  lines() {
    const { spec } = this;
    /** @type {uPlot.Series[]} */
    const lines = spec.lines.map((line) => ({ label: line.label, stroke: colour(line.color), width: rem() / 8, dash: line.dash, points: { show: false }, value: (_, value) => shown(value) }));
    if (!spec.limit) return lines;
    const limit = { stroke: colour("limit"), dash: [6, 4], width: 1.25, points: { show: false }, value: (/** @type {uPlot} */ _, /** @type {number} */ value) => shown(value) };
    return [...lines, { ...limit, label: "threshold" }, { ...limit, label: "− threshold", class: "silent" }];
  }

  /** @returns {Data} */
  table() {
    const { limit } = this.spec;
    if (!limit) return this.data;
    return [...this.data, this.data[0].map(() => limit), this.data[0].map(() => -limit)];
  }

  /** @param {uPlot} plot */
  range(plot) {
    const [t] = this.data;
    if (this.fixed) return plot.setScale("x", this.fixed);
    if (t.length === 0) return;
    const [first, last] = [t[0], t[t.length - 1]];
    plot.setScale("x", this.span > 0 ? following(first, last, this.span) : { min: first, max: last });
  }

  /**
   * Shows other values.
   * @param {Data} data
   * @param {number} span seconds in sight; 0 for all
   * @param {{ min: number, max: number } | null} [fixed] what is in sight, whatever the values
   */
  update(data, span, fixed = null) {
    this.data = data;
    this.span = span;
    this.fixed = fixed;
    this.plot.batch(() => {
      this.plot.setData(this.table(), false);
      if (!this.held) this.range(this.plot);
    });
    // Away from the chart the legend reads out the newest value.
    if ((this.plot.cursor.left ?? -1) < 0) this.plot.setLegend({ idx: data[0].length - 1 }, false);
  }

  hold() {
    this.held = true;
    show(this.follow, true);
  }

  release() {
    this.held = false;
    show(this.follow, false);
    this.range(this.plot);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const { plot } = this;
    const [t] = this.data;
    const at = plot.cursor.idx ?? t.length - 1;
    const move = { ArrowRight: 1, ArrowLeft: -1, PageDown: 10, PageUp: -10 }[event.key];
    const factor = { "+": 0.5, "-": 2 }[event.key];
    if (t.length === 0) return;
    if (move) {
      const x = t[Math.min(Math.max(at + move, 0), t.length - 1)];
      plot.setCursor({ left: plot.valToPos(x, "x"), top: plot.over.clientHeight / 2 });
    } else if (factor) {
      const half = (factor * ((plot.scales.x.max ?? 1) - (plot.scales.x.min ?? 0))) / 2;
      this.hold();
      plot.setScale("x", { min: Math.max(t[at] - half, t[0]), max: Math.min(t[at] + half, t[t.length - 1]) });
    } else if (event.key === "Escape") this.release();
    else return;
    event.preventDefault();
  }

  /** The chart with title and legend, as an image. */
  image() {
    const { spec, plot } = this;
    const source = plot.ctx.canvas;
    const scale = source.width / plot.width;
    const line = rem() * scale;
    const canvas = make("canvas", { width: source.width, height: Math.round(source.height + PNG_LINES * line) });
    const context = canvas.getContext("2d");
    if (!context) return canvas;
    context.fillStyle = colour("paper");
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.fillStyle = colour("ink");
    context.font = `600 ${line}px system-ui, sans-serif`;
    context.fillText(`${spec.title} (${spec.unit})`, 0.6 * line, 1.2 * line);
    context.font = `${0.8 * line}px system-ui, sans-serif`;
    let x = 0.6 * line;
    for (const { label, color } of spec.lines) {
      context.fillStyle = colour(color);
      context.fillRect(x, 1.75 * line, 0.9 * line, 0.22 * line);
      context.fillText(label, x + 1.1 * line, 2.1 * line);
      x += 1.9 * line + context.measureText(label).width;
    }
    context.drawImage(source, 0, PNG_LINES * line);
    return canvas;
  }

  save() {
    this.image().toBlob((blob) => {
      if (!blob) return;
      const link = make("a", { href: URL.createObjectURL(blob), download: `${this.spec.id}.png` });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    }, "image/png");
  }
}
