// Steps 2 and 3: a file of the recorder, what was assumed of it, and whether the motor was in good order in it.

import { make } from "../dom.js";
import { columnForm } from "../workbench/columns.js";
import { ACCEPT, findings, inWords, load } from "../workbench/recordings.js";
import * as server from "../workbench/server.js";

/** @typedef {import("../workbench/messages").View} View */
/** @typedef {import("../workbench/messages").RecordingView} RecordingView */
/** @typedef {(work: () => Promise<View>) => Promise<boolean>} Change takes the state that comes; a refusal is said at the step, and is `false` */

/**
 * Whether a recording can be checked.
 * @param {RecordingView | null | undefined} recording
 * @returns {boolean}
 */
export function isUsable(recording) {
  return recording?.summary?.kind === "recording";
}

/**
 * A place to drop a file on, or to choose one.
 * @param {number} slot
 * @param {View} view
 * @param {string} words
 * @param {Change} change
 * @param {() => void} [done] when the file could be read
 */
export function drop(slot, view, words, change, done) {
  const id = `first-file-${slot}`;
  const input = make("input", { type: "file", id, accept: ACCEPT, multiple: true });
  const zone = make("div", { class: "drop" }, make("label", { for: id }, words), input);
  const take = async (/** @type {File[]} */ files) => {
    if (files.length === 0) return;
    if (await change(() => load(slot, files, view.most_bytes, view.recordings[slot]))) done?.();
  };
  input.addEventListener("change", () => take([...(input.files ?? [])]));
  zone.addEventListener("dragover", (event) => {
    event.preventDefault();
    zone.classList.add("over");
  });
  zone.addEventListener("dragleave", () => zone.classList.remove("over"));
  zone.addEventListener("drop", (event) => {
    event.preventDefault();
    zone.classList.remove("over");
    take([...(event.dataTransfer?.files ?? [])]);
  });
  return zone;
}

/**
 * A list under a heading that opens; nothing for an empty list.
 * @param {string} heading
 * @param {string[]} lines
 * @param {boolean} open
 */
function list(heading, lines, open) {
  if (lines.length === 0) return [];
  return [make("details", { class: "assumed", open }, make("summary", {}, `${heading} (${lines.length})`), make("ul", {}, ...lines.map((line) => make("li", {}, line))))];
}

/**
 * What is in a file; its columns are asked for only where the reader could not know them.
 * @param {number} slot
 * @param {RecordingView} recording
 * @param {Change} change
 * @returns {Node[]}
 */
export function content(slot, recording, change) {
  const { summary, problem, blind } = recording;
  /** @type {Node[]} */
  const parts = [make("p", { class: "file-name" }, make("b", {}, recording.name), recording.sidecar ? ` with ${recording.sidecar}` : "")];
  if (summary) parts.push(make("p", { class: "holds" }, inWords(summary)));
  if (summary?.kind === "load-table") parts.push(make("p", { class: "problem", role: "alert" }, "A load table has no waveforms to judge. Choose a recording of voltages and currents; the workbench takes the table."));
  if (problem) parts.push(make("p", { class: "problem", role: "alert" }, problem));
  if (summary?.kind === "recording") parts.push(...list("Assumed of this file", summary.notes, true));
  parts.push(...findings(recording));
  parts.push(...list("What these channels leave dark", (blind ?? []).map(({ unseen, needs }) => `${unseen} – needs ${needs}`), true));
  const form = columnForm(`first-slot-${slot}`, recording, (columns) => change(async () => server.send(`/recordings/${slot}/mapping?id=${recording.id}`, columns())));
  parts.push(make("details", { class: "mapping", open: problem !== null }, make("summary", {}, "Preview and columns"), form));
  return parts;
}
