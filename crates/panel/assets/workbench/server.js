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
  if (!kind.startsWith("application/json")) return new Error((await answer.text()).trim() || `the server answers ${answer.status}`);
  const { message, problems } = await answer.json();
  return new Refused(message, problems ?? []);
}

/** What the server refuses, with the fields that are to blame. */
export class Refused extends Error {
  /**
   * @param {string} message
   * @param {import("../messages").Refusal["problems"]} problems
   */
  constructor(message, problems) {
    super(message);
    this.problems = problems;
  }
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

/** Stops the question that is being worked on, as soon as its present step ends. */
export const stop = () => send("/jobs/stop");

/** @returns {Promise<import("./messages").Question[]>} */
export const form = () => ask("/check/form");

/**
 * @param {Record<string, string>} typed
 * @returns {Promise<import("./messages").Attempt>}
 */
export const attempt = (typed) => ask("/check/attempt", { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(typed) });

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
