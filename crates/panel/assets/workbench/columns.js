// The first rows of a file, and which of its columns is which signal.

import { make } from "../dom.js";

/** @typedef {import("./messages").Columns} Columns */
/** @typedef {import("./messages").RecordingView} RecordingView */

/** Channels and the units that each may have, SI first. */
export const CHANNELS = /** @type {const} */ ([
  ["t", "time", ["s", "ms", "us", "ns", "min"]],
  ["va", "voltage a", ["V", "mV", "kV"]], ["vb", "voltage b", ["V", "mV", "kV"]], ["vc", "voltage c", ["V", "mV", "kV"]],
  ["ia", "current a", ["A", "mA", "kA"]], ["ib", "current b", ["A", "mA", "kA"]], ["ic", "current c", ["A", "mA", "kA"]],
  ["speed", "speed", ["rad/s", "rpm", "rev/s", "Hz", "deg/s", "counts"]], ["torque", "brake torque", ["Nm", "mNm", "kNm", "lbf.ft", "lbf.in"]],
  ["temperature", "temperature", ["degC", "K", "degF"]],
]);

/**
 * The request that a form means: what is empty is not said. Text where a number belongs is an error.
 * @param {FormData} form
 * @returns {Columns}
 */
export function columnsOf(form) {
  const text = (/** @type {string} */ name) => String(form.get(name) ?? "").trim();
  const number = (/** @type {string} */ name) => {
    if (text(name) === "") return null;
    const value = Number(text(name));
    if (!Number.isFinite(value)) throw new Error(`"${text(name)}" is no number; write it with a decimal point, as 5000.5`);
    return value;
  };
  /** @type {Columns} */
  const columns = {
    column: {}, unit: {}, scale: {}, offset: {}, delay: {}, sample_rate_hz: number("sample_rate_hz"), delimiter: text("delimiter"),
    decimal_comma: form.has("decimal_comma"), line_voltages: form.has("line_voltages"), skip_missing: form.has("skip_missing"),
    pulses_per_revolution: number("pulses_per_revolution"),
  };
  for (const [channel] of CHANNELS) {
    for (const what of /** @type {const} */ (["column", "unit", "scale", "offset", "delay"])) {
      const said = text(`${what}-${channel}`);
      if (said !== "") columns[what][channel] = said;
    }
  }
  return columns;
}

/** @param {{ columns: string[], rows: string[][] }} preview */
function table({ columns, rows }) {
  const head = make("tr", {}, ...columns.map((name) => make("th", { scope: "col" }, name)));
  const body = rows.map((cells) => make("tr", {}, ...cells.map((cell) => make("td", {}, cell))));
  return make("div", { class: "wide", tabindex: "0" }, make("table", { class: "preview", "aria-label": "First rows of the file" }, make("thead", {}, head), make("tbody", {}, ...body)));
}

/**
 * @param {string} id
 * @param {string} name
 * @param {string} label
 * @param {[string, string][]} options values and words
 * @param {string} chosen
 */
function select(id, name, label, options, chosen) {
  const made = make("select", { id, name, "aria-label": label }, ...options.map(([value, words]) => make("option", { value, selected: value === chosen }, words)));
  return made;
}

const PLACEHOLDERS = { scale: "1", offset: "0", delay: "0us" };

/**
 * @param {string} id
 * @param {RecordingView} recording
 * @param {typeof CHANNELS[number]} channel
 */
function row(id, recording, [channel, words, units]) {
  const { columns } = recording;
  const names = recording.preview?.columns ?? [];
  const said = columns.column[channel] ?? "";
  const offered = said === "" || names.includes(said) ? names : [...names, said];
  const own = names.includes(channel) ? channel : "–";
  const column = select(`${id}-column-${channel}`, `column-${channel}`, `Column of ${words}`, [["", own], ...offered.filter((name) => name !== "" && name !== channel).map((name) => /** @type {[string, string]} */ ([name, name]))], said);
  const unit = select(`${id}-unit-${channel}`, `unit-${channel}`, `Unit of ${words}`, [["", "default"], ...units.map((name) => /** @type {[string, string]} */ ([name, name]))], columns.unit[channel] ?? "");
  const number = (/** @type {"scale" | "offset" | "delay"} */ what, /** @type {string} */ label) => {
    const input = make("input", { name: `${what}-${channel}`, inputmode: "decimal", size: 5, "aria-label": `${label} of ${words}`, placeholder: PLACEHOLDERS[what], autocomplete: "off" });
    input.value = columns[what][channel] ?? "";
    return input;
  };
  return make("tr", {}, make("th", { scope: "row" }, words, " ", make("abbr", {}, channel)), make("td", {}, column), make("td", {}, unit), make("td", {}, number("scale", "Factor")), make("td", {}, number("offset", "Reading at zero")), make("td", {}, number("delay", "Sampled later by")));
}

/**
 * @param {string} name
 * @param {string} words
 * @param {boolean} checked
 */
function box(name, words, checked) {
  return make("label", {}, make("input", { type: "checkbox", name, checked }), ` ${words}`);
}

/**
 * @param {string} name
 * @param {string} words
 * @param {number | null} value
 */
function field(name, words, value) {
  const input = make("input", { name, inputmode: "decimal", size: 9, autocomplete: "off" });
  input.value = value === null ? "" : String(value);
  return make("label", {}, `${words} `, input);
}

/**
 * Preview and form of a file.
 * @param {string} id unique on the page
 * @param {RecordingView} recording
 * @param {(columns: () => Columns) => void} apply
 */
export function columnForm(id, recording, apply) {
  const { columns } = recording;
  const head = make("tr", {}, ...["signal", "column", "unit", "factor", "zero", "later by"].map((words) => make("th", { scope: "col", class: "word" }, words)));
  const separators = /** @type {[string, string][]} */ ([["", "comma"], [";", "semicolon ;"], ["tab", "tab"], ["|", "bar |"]]);
  const form = make("form", { class: "columns", novalidate: true },
    ...(recording.preview ? [table(recording.preview)] : []),
    make("p", { class: "options" }, make("label", {}, "Columns are separated by ", select(`${id}-delimiter`, "delimiter", "Separator", separators, columns.delimiter)), box("decimal_comma", "numbers are written 3,7", columns.decimal_comma), box("line_voltages", "va vb vc hold line voltages", columns.line_voltages), box("skip_missing", "leave out rows with empty cells", columns.skip_missing), field("sample_rate_hz", "Sampling rate without a time column, Hz", columns.sample_rate_hz), field("pulses_per_revolution", "Encoder pulses per turn", columns.pulses_per_revolution)),
    make("div", { class: "wide", tabindex: "0" }, make("table", { "aria-label": "Columns and signals" }, make("thead", {}, head), make("tbody", {}, ...CHANNELS.map((channel) => row(id, recording, channel))))),
    make("p", { class: "subtle" }, "A column of a signal’s own name needs no choice. Units are those that the file or its sidecar declares, or SI. Signal = factor × (column − zero). The factor of the speed may be the word unknown: compare, explain and adopt then fit it. A channel that was sampled later than its row says by how much, with its unit: 11.55us."),
    make("p", { class: "actions" }, make("button", { type: "submit", class: "main" }, "Read again")));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    apply(() => columnsOf(new FormData(form)));
  });
  return form;
}
