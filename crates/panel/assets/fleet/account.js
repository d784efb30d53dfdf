// Who sits before the page, and what that person may do.

import { byId, of, say, show } from "../dom.js";
import { ask, send } from "./server.js";

/** @typedef {import("./messages").Me} Me */

/** @type {Me} */
let me = { name: null, role: null };
/** @type {(() => void)[]} */
const waiting = [];

/** Whether alarms may be acknowledged. */
export const mayAct = () => me.role === "acknowledge" || me.role === "configure";

/**
 * Tells when somebody signed in or out.
 * @param {() => void} then
 */
export const onChange = (then) => waiting.push(then);

/** @param {Me} now */
function take(now) {
  me = now;
  say(byId("me"), me.name ? `${me.name} · ${me.role}` : "");
  say(byId("sign"), me.name ? "Sign out" : "Sign in");
  for (const then of waiting) then();
}

/** Asks for a token, once at a time. */
export function signIn() {
  const dialog = of("sign-in", HTMLDialogElement);
  if (!dialog.open) dialog.showModal();
}

/** @param {Event} event */
async function submit(event) {
  event.preventDefault();
  const token = of("token", HTMLInputElement);
  const { answer, problem } = await send("session", { token: token.value });
  show(byId("sign-problem"), problem !== null);
  say(byId("sign-problem"), problem ?? "");
  if (!answer) return;
  token.value = "";
  of("sign-in", HTMLDialogElement).close();
  take(/** @type {Me} */ (answer));
}

async function sign() {
  if (!me.name) return signIn();
  const { answer } = await send("session/end", {});
  if (answer) location.reload();
}

/** Wires the dialog, and asks who is here. */
export async function start() {
  byId("sign").addEventListener("click", sign);
  byId("sign-cancel").addEventListener("click", () => of("sign-in", HTMLDialogElement).close());
  byId("sign-in").addEventListener("submit", submit);
  await refresh();
}

/** Asks who is here; nobody who may see: asks for a token. */
export async function refresh() {
  const { answer } = await ask("me");
  if (!answer) return;
  take(/** @type {Me} */ (answer));
  if (me.role === null) signIn();
}
