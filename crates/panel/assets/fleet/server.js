// Questions to the server.

/**
 * @template T
 * @typedef {{ answer: T, problem: null, status: number } | { answer: null, problem: string, status: number }} Answer
 */

/**
 * @template T
 * @param {string} path
 * @param {RequestInit} [request]
 * @returns {Promise<Answer<T>>}
 */
async function talk(path, request) {
  try {
    const response = await fetch(path, request);
    const { status } = response;
    const kind = response.headers.get("content-type") ?? "";
    if (!kind.startsWith("application/json")) return { answer: null, status, problem: (await response.text()).trim() || `the server answers ${status}` };
    const body = await response.json();
    return response.ok ? { answer: body, problem: null, status } : { answer: null, problem: body.message, status };
  } catch {
    return { answer: null, problem: "the server does not answer: does it still run?", status: 0 };
  }
}

/**
 * @template T
 * @param {string} path below /api/fleet/
 * @param {Record<string, string | number>} [query]
 * @returns {Promise<Answer<T>>}
 */
export function ask(path, query = {}) {
  const parameters = new URLSearchParams(Object.entries(query).map(([key, value]) => [key, String(value)]));
  return talk(`/api/fleet/${path}?${parameters}`);
}

/**
 * @template T
 * @param {string} path below /api/fleet/
 * @param {unknown} body
 * @returns {Promise<Answer<T>>}
 */
export const send = (path, body) => talk(`/api/fleet/${path}`, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) });
