// The two places for recordings: choose, see what is in it, say what its columns are.

import { make } from "../dom.js";
import { shown } from "../format.js";
import { columnForm } from "./columns.js";
import * as server from "./server.js";

/** @typedef {import("./messages").View} View */
/** @typedef {import("./messages").RecordingView} RecordingView */
/** @typedef {(work: () => Promise<View>, at?: string) => void} Change takes the state that comes; a refusal is said at the input of this id */

const PLACES = [
  { title: "Recording to fit", help: "Compared and fitted. CSV, CSV.gz, Parquet, MAT, COMTRADE .cff, or a load-test table; choose its sidecar .toml together with it." },
  { title: "Recording to prove with", help: "Another run of the same motor, never fitted. Without it, parts of the first that were left out prove." },
];
export const ACCEPT = ".csv,.gz,.parquet,.mat,.cff,.xlsx,.wav,.tsv,.txt,.dat,.toml";

/**
 * Recording and sidecar among the chosen files.
 * @template {{ name: string }} T
 * @param {T[]} files
 * @returns {{ recording: T | undefined, sidecar: T | undefined }}
 */
export function sorted(files) {
  const isSidecar = (/** @type {T} */ file) => file.name.toLowerCase().endsWith(".toml");
  return { recording: files.find((file) => !isSidecar(file)), sidecar: files.find(isSidecar) };
}

/**
 * What a file holds, in a line.
 * @param {import("./messages").Summary} summary
 * @returns {string}
 */
export function inWords(summary) {
  if (summary.kind === "load-table") return `Load table: ${summary.points} points of ${summary.columns.join(", ")}`;
  return `${shown(summary.duration_s)} s at ${shown(summary.sample_rate_hz / 1000)} kHz: ${summary.channels.join(", ")}`;
}

/**
 * @param {number} slot
 * @param {File[]} files
 * @param {number} most bytes
 * @param {RecordingView | null} present what lies there
 * @returns {Promise<View>}
 */
export async function load(slot, files, most, present) {
  const { recording, sidecar } = sorted(files);
  const path = `/recordings/${slot}`;
  const query = (/** @type {File} */ file, rest = "") => `?name=${encodeURIComponent(file.name)}${rest}`;
  if (recording && recording.size > most) throw new Error(`${recording.name}: is larger than ${Math.round(most / 2 ** 20)} MiB; cut the recording, a few seconds with load steps are enough`);
  if (recording && !sidecar) return server.upload(`${path}/file${query(recording)}`, recording);
  if (!sidecar) throw new Error("choose a file");
  const sent = recording ? (await server.upload(`${path}/file${query(recording, "&sidecar_follows=true")}`, recording)).recordings[slot] : present;
  if (!sent) throw new Error("choose the recording together with its sidecar");
  return server.upload(`${path}/sidecar${query(sidecar, `&id=${sent.id}`)}`, sidecar);
}

/** @param {RecordingView} recording */
export function findings({ audit }) {
  if (!audit || audit.findings.length === 0) return [];
  const title = audit.supported ? "What the audit noticed" : "The audit refuses this recording";
  const list = audit.findings.map((finding) => make("li", { class: finding.refuses ? "refuses" : null }, make("strong", {}, `${finding.code} ${finding.channel}: `), finding.detail));
  return [make("details", { class: "audit", open: !audit.supported }, make("summary", {}, `${title} (${audit.findings.length})`), make("ul", { class: "findings" }, ...list))];
}

/**
 * @param {number} slot
 * @param {RecordingView} recording
 * @param {Change} change
 */
function content(slot, recording, change) {
  const { summary, problem } = recording;
  /** @type {HTMLElement[]} */
  const parts = [make("p", { class: "file-name" }, make("b", {}, recording.name), recording.sidecar ? ` with ${recording.sidecar}` : "")];
  if (summary) parts.push(make("p", { class: "holds" }, inWords(summary)));
  if (problem) parts.push(make("p", { class: "problem", role: "alert" }, problem));
  parts.push(...findings(recording));
  const form = columnForm(`slot-${slot}`, recording, (columns) => change(async () => server.send(`/recordings/${slot}/mapping?id=${recording.id}`, columns())));
  parts.push(make("details", { class: "mapping", open: problem !== null }, make("summary", {}, "Preview and columns"), form));
  const remove = make("button", { type: "button" }, "Remove");
  remove.addEventListener("click", () => change(() => server.send(`/recordings/${slot}/remove?id=${recording.id}`)));
  return [...parts, make("p", { class: "actions" }, remove)];
}

/**
 * @param {number} slot
 * @param {View} view
 * @param {Change} change
 */
function card(slot, view, change) {
  const { title, help } = PLACES[slot];
  const input = make("input", { type: "file", id: `file-${slot}`, accept: ACCEPT, multiple: true, "aria-describedby": `file-${slot}-help` });
  const recording = view.recordings[slot];
  const choose = make("p", {}, make("label", { for: input.id, class: "choose" }, recording ? "Choose another file " : "Choose a file "), input);
  input.addEventListener("change", () => {
    const files = [...(input.files ?? [])];
    if (files.length > 0) change(() => load(slot, files, view.most_bytes, recording), input.id);
  });
  return make("section", { class: "card", "aria-labelledby": `place-${slot}`, "data-slot": slot }, make("h3", { id: `place-${slot}` }, title), make("p", { class: "subtle", id: `file-${slot}-help` }, help), choose, ...(recording ? content(slot, recording, change) : []));
}

/**
 * @param {HTMLElement} holder
 * @param {View} view
 * @param {Change} change
 */
export function render(holder, view, change) {
  holder.replaceChildren(...PLACES.map((_, slot) => card(slot, view, change)));
}
