// What the workbench asks of the server.

/** @typedef {import("./messages").View} View */

const ROOT = "/api/workbench";

/**
 * The words of an answer that is a refusal.
 * @param {Response} answer
 * @returns {Promise<Error>}
 */
async function refusal(answer) {
  const kind = answer.headers.get("content-type") ?? "";
  const words = kind.startsWith("application/json") ? (await answer.json()).message : (await answer.text()).trim();
  return new Error(words || `the server answers ${answer.status}`);
}

/**
 * @template T
 * @param {string} path
 * @param {RequestInit} [request]
 * @returns {Promise<T>}
 */
async function ask(path, request) {
  const answer = await fetch(ROOT + path, request).catch(() => {
    throw new Error("the panel does not answer: is it still running?");
  });
  if (!answer.ok) throw await refusal(answer);
  return answer.json();
}

/** @returns {Promise<View>} */
export const state = () => ask("/state");

/**
 * @param {string} path
 * @param {unknown} [body]
 * @returns {Promise<View>}
 */
export const send = (path, body = {}) => ask(path, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) });

/**
 * @param {string} path with a query
 * @param {Blob} file
 * @returns {Promise<View>}
 */
export const upload = (path, file) => ask(path, { method: "POST", headers: { "content-type": "application/octet-stream" }, body: file });

/**
 * @param {string} kind
 * @returns {Promise<import("./messages").Answer>}
 */
export const result = (kind) => ask(`/results/${kind}`);

/**
 * @param {number} from_s
 * @param {number} to_s
 * @returns {Promise<import("./messages").Traces>}
 */
export const region = (from_s, to_s) => ask(`/region?from_s=${from_s}&to_s=${to_s}`);
