// The motor file: which one, what was adopted, undo, save.

import { make } from "../dom.js";
import * as server from "./server.js";

/** @typedef {import("./messages").View} View */

/**
 * @param {View} view
 * @param {import("./recordings.js").Change} change
 */
function choice(view, change) {
  const options = [make("option", { value: "" }, "another one …"), make("option", { value: "panel" }, "the panel’s, as it is now"), ...view.shipped.map((name) => make("option", { value: name }, name))];
  const select = make("select", { id: "motor-choice" }, ...options);
  const input = make("input", { type: "file", id: "motor-file", accept: ".toml" });
  const place = make("p", { class: "options" }, make("label", { for: select.id }, "Take "), select, make("label", { for: input.id }, "or a file "), input);
  select.addEventListener("change", () => {
    if (select.value !== "") change(() => server.send("/motor", { shipped: select.value === "panel" ? null : select.value }), select.id);
  });
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    if (file) change(() => server.upload(`/motor/file?name=${encodeURIComponent(file.name)}`, file), input.id);
  });
  return place;
}

/**
 * @param {HTMLElement} holder
 * @param {View} view
 * @param {import("./recordings.js").Change} change
 */
export function render(holder, view, change) {
  const { motor } = view;
  const parts = [make("h3", { id: "motor-title" }, "Motor file")];
  if (motor) {
    const effects = motor.effects.length > 0 ? `Effects in its model: ${motor.effects.join(", ")}.` : "No effects beyond the usual equations.";
    const undo = make("button", { type: "button", id: "undo", hidden: motor.adopted.length === 0 }, `Undo ${motor.adopted.at(-1) ?? ""}`);
    undo.addEventListener("click", () => change(() => server.send("/motor/undo")));
    const save = make("a", { id: "save-motor", class: "button", href: "/api/workbench/motor.toml", download: motor.file }, "Save motor file");
    parts.push(make("p", { class: "file-name" }, make("b", {}, motor.name), ` (${motor.file})`), make("p", { class: "holds" }, effects), make("p", { class: "actions" }, save, " ", undo));
  } else {
    parts.push(make("p", {}, "None yet: take a shipped one or choose a file."));
  }
  holder.replaceChildren(make("section", { class: "card", "aria-labelledby": "motor-title" }, ...parts, choice(view, change)));
}
