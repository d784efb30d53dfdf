// Voltage, current and rotor flux as arrows in the monitor's d-q frame.

import { fixed } from "./format.js";

const SVG = "http://www.w3.org/2000/svg";
/** Longest arrow, in units of the drawing whose radius is 100. */
const REACH = 86;

/**
 * @typedef {object} Arrow
 * @property {string} name
 * @property {string} symbol
 * @property {string} unit
 * @property {import("./messages").Pair} dq
 * @property {number} full value whose arrow is `share` long
 * @property {number} share of the longest arrow
 */

/**
 * Length and angle of a vector.
 * @param {import("./messages").Pair} dq
 */
export function polar([d, q]) {
  return { length: Math.hypot(d, q), degrees: (Math.atan2(q, d) * 180) / Math.PI };
}

/**
 * The end of an arrow in the drawing: d to the right, q upwards, never beyond the rim.
 * @param {Pick<Arrow, "dq" | "full" | "share">} arrow
 * @returns {import("./messages").Pair}
 */
export function tip({ dq, full, share }) {
  const { length } = polar(dq);
  if (!(length > 0) || !(full > 0)) return [0, 0];
  const drawn = Math.min((length / full) * share, 1.12) * REACH;
  return [(dq[0] / length) * drawn, (-dq[1] / length) * drawn];
}

/**
 * @param {import("./messages").Vectors} vectors
 * @param {import("./messages").Pair | null} rated voltage and current amplitude
 * @param {number | null} omega supply frequency, rad/s
 * @returns {Arrow[]}
 */
export function arrows(vectors, rated, omega) {
  const [volt, amp] = rated ?? [polar(vectors.u_dq_volt).length, polar(vectors.i_dq_amp).length];
  const flux = omega ? volt / omega : polar(vectors.psi_r_dq_volt_second).length;
  return [
    { name: "voltage", symbol: "V", unit: "V", dq: vectors.u_dq_volt, full: volt, share: 1 },
    { name: "current", symbol: "I", unit: "A", dq: vectors.i_dq_amp, full: amp, share: 0.72 },
    { name: "flux", symbol: "ψr", unit: "V s", dq: vectors.psi_r_dq_volt_second, full: flux, share: 0.86 },
  ];
}

/**
 * @param {string} tag
 * @param {Record<string, string | number>} attributes
 * @param {string} [text]
 */
function shape(tag, attributes, text) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  if (text) made.textContent = text;
  return made;
}

/** The diagram and its numbers. */
export class VectorDiagram {
  /** @param {HTMLElement} box */
  constructor(box) {
    this.svg = shape("svg", { viewBox: "-112 -112 224 224", role: "img", "aria-label": "vector diagram", class: "vectors" });
    for (const r of [REACH, REACH / 2]) this.svg.append(shape("circle", { r, class: "ring" }));
    this.svg.append(shape("line", { x1: -100, x2: 100, class: "axis" }), shape("line", { y1: -100, y2: 100, class: "axis" }));
    this.svg.append(shape("text", { x: 103, y: 14, class: "axis-name" }, "d"), shape("text", { x: -14, y: -100, class: "axis-name" }, "q"));
    /** @type {Map<string, {line: Element, head: Element, label: Element, number: HTMLElement}>} */
    this.parts = new Map();
    this.numbers = document.createElement("dl");
    this.numbers.className = "vector-numbers";
    box.append(this.svg, this.numbers);
    this.note = document.createElement("p");
    this.note.className = "subtle";
    box.append(this.note);
  }

  /** @param {Arrow} arrow */
  part(arrow) {
    const known = this.parts.get(arrow.name);
    if (known) return known;
    const line = shape("line", { class: `arrow ${arrow.name}` });
    const head = shape("polygon", { class: `head ${arrow.name}` });
    const label = shape("text", { class: `arrow-name ${arrow.name}` }, arrow.symbol);
    this.svg.append(line, head, label);
    const term = document.createElement("dt");
    term.className = arrow.name;
    term.textContent = arrow.symbol;
    const number = document.createElement("dd");
    this.numbers.append(term, number);
    const made = { line, head, label, number };
    this.parts.set(arrow.name, made);
    return made;
  }

  /**
   * @param {import("./messages").WindowMessage} window
   * @param {import("./messages").Pair | null} rated
   */
  render(window, rated) {
    const { vectors } = window;
    this.svg.classList.toggle("absent", !vectors);
    if (!vectors) {
      this.note.textContent = "Vectors need voltages, currents, speed and a motor file.";
      return;
    }
    const frequency = window.operation.frequency_hz;
    for (const arrow of arrows(vectors, rated, frequency ? 2 * Math.PI * frequency : null)) this.draw(arrow);
    this.note.textContent = vectors.frame === "rotor-flux" ? "d lies on the rotor flux. Amplitudes; each arrow is scaled by its rated value." : "q lies on the voltage. Amplitudes; each arrow is scaled by its rated value.";
  }

  /** @param {Arrow} arrow */
  draw(arrow) {
    const [x, y] = tip(arrow);
    const { line, head, label, number } = this.part(arrow);
    const { length, degrees } = polar(arrow.dq);
    const drawn = Math.hypot(x, y) || 1;
    const [ux, uy] = [x / drawn, y / drawn];
    line.setAttribute("x2", String(x - 8 * ux));
    line.setAttribute("y2", String(y - 8 * uy));
    head.setAttribute("points", `${x},${y} ${x - 10 * ux - 4.2 * uy},${y - 10 * uy + 4.2 * ux} ${x - 10 * ux + 4.2 * uy},${y - 10 * uy - 4.2 * ux}`);
    label.setAttribute("x", String(x + 9 * ux));
    label.setAttribute("y", String(y + 9 * uy + 4));
    const digits = length >= 100 ? 0 : length >= 10 ? 1 : 3;
    number.textContent = `${fixed(length, digits)} ${arrow.unit} ∠ ${fixed(degrees, 0)}°`;
  }
}
