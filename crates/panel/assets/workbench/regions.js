// A part of the recording is clicked, and its traces are shown.

import { make } from "../dom.js";
import { fixed } from "../format.js";
import * as server from "./server.js";

/** @typedef {import("./messages").Result} Result */
/** @typedef {import("./messages").Band} Band */
/** @typedef {{ name: string, from_s: number, to_s: number }} Part */

/** Time around the worst place of a band, s: some periods of the supply. */
const AROUND_S = 0.12;

/**
 * What a block of the recording has of a quantity, percent.
 * @param {import("./messages").Block} block
 * @param {Band["quantity"]} quantity
 * @param {number} rated_hz
 * @returns {number | null}
 */
function percentOf(block, quantity, rated_hz) {
  if (quantity === "frequency") return block.frequency_hz === null ? null : (100 * block.frequency_hz) / rated_hz;
  return { load: block.load_percent, voltage: block.voltage_percent, slip: block.slip_percent }[quantity];
}

/**
 * The worst place of a band; `null` where the recording is never in it.
 * @param {Result} result
 * @param {Band} band
 * @param {number} rated_hz
 * @returns {Part | null}
 */
export function worstOf(result, band, rated_hz) {
  const within = (result.overlay?.blocks ?? []).filter((block) => {
    const percent = percentOf(block, band.quantity, rated_hz);
    return percent !== null && Math.abs(percent) >= band.from_percent && Math.abs(percent) < band.to_percent;
  });
  const [worst] = within.sort((a, b) => b.current_error_amp[0] - a.current_error_amp[0]);
  if (!worst) return null;
  return { name: `${band.quantity} ${band.from_percent} to ${band.to_percent} %, at its worst`, from_s: worst.t - AROUND_S / 2, to_s: worst.t + AROUND_S / 2 };
}

/**
 * Turns the text of a cell into a button.
 * @param {Element | null | undefined} cell
 * @param {Part | null} part
 * @param {(part: Part) => void} open
 */
function pressable(cell, part, open) {
  if (!cell || !part) return;
  const button = make("button", { type: "button", class: "region", "aria-label": `Show ${part.name}: ${fixed(part.from_s, 2)} to ${fixed(part.to_s, 2)} s` });
  button.append(...cell.childNodes);
  button.addEventListener("click", () => open(part));
  cell.append(button);
}

/**
 * Makes regions, bands and the worst places of a comparison open their traces.
 * @param {HTMLElement} holder
 * @param {Result} result
 * @param {import("./messages").Figures} figures
 * @param {number} rated_hz
 * @param {(words: string) => void} complain
 */
export function wire(holder, result, figures, rated_hz, complain) {
  const overlay = result.overlay;
  const heading = holder.querySelector("[aria-labelledby$=overlay]");
  if (!overlay || !(heading instanceof HTMLElement)) return;
  const note = make("p", { class: "region-note", role: "status" }, "Click a part of the recording below, or a cell of the map above, to see its traces here.");
  heading.querySelector("h2")?.after(note);
  const open = async (/** @type {Part} */ part) => {
    try {
      overlay.close = await server.region(part.from_s, part.to_s);
    } catch (error) {
      complain(error instanceof Error ? error.message : String(error));
      return;
    }
    figures.redraw("/overlay/close");
    for (const title of heading.querySelectorAll("h3")) title.textContent = (title.textContent ?? "").replace(/, where .*|: .* s$/, `: ${fixed(part.from_s, 2)} to ${fixed(part.to_s, 2)} s`);
    note.textContent = `Now shown: ${part.name}, ${fixed(part.from_s, 2)} to ${fixed(part.to_s, 2)} s.`;
    heading.scrollIntoView({ behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth", block: "start" });
  };
  const rows = holder.querySelectorAll("[aria-labelledby$=regions] tbody tr");
  (result.regions ?? []).forEach((region, k) => pressable(rows[k]?.querySelector("th"), region, open));
  for (const cell of holder.querySelectorAll("td[data-from], td:has([data-from])")) {
    const from = (cell.querySelector("[data-from]") ?? cell).getAttribute("data-from") ?? "";
    const found = /^\/bands\/(\d+)\//.exec(from);
    const band = found && result.bands?.[Number(found[1])];
    if (band) pressable(cell, worstOf(result, band, rated_hz), open);
  }
}
