// Small helpers around the document.

/**
 * The element with an id of index.html.
 * @param {string} id
 * @returns {HTMLElement}
 */
export function byId(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found;
}

/**
 * The same, of a kind.
 * @template {HTMLElement} T
 * @param {string} id
 * @param {{ new (): T }} kind
 * @returns {T}
 */
export function of(id, kind) {
  const found = byId(id);
  if (!(found instanceof kind)) throw new Error(`#${id} is no ${kind.name}`);
  return found;
}

/**
 * A new element; attributes that are `null` are left out.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, string | number | boolean | null>} [attributes]
 * @param {...(Node | string)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function make(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false) made.setAttribute(name, value === true ? "" : String(value));
  }
  made.append(...children);
  return made;
}

/**
 * Sets text only when it is another one: screen readers announce every change.
 * @param {Element} element
 * @param {string} text
 */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/**
 * @param {HTMLElement} element
 * @param {boolean} shown
 */
export function show(element, shown) {
  if (element.hidden === shown) element.hidden = !shown;
}

/**
 * Lets an element grow but not shrink: what a person is about to click below it stays where it is.
 * @param {HTMLElement} element
 */
export function neverShrinks(element) {
  let width = 0;
  let tallest = 0;
  new ResizeObserver(() => {
    const now = element.getBoundingClientRect();
    if (now.width !== width) {
      [width, tallest] = [now.width, 0];
      element.style.minHeight = "";
      return;
    }
    if (now.height <= tallest) return;
    tallest = now.height;
    element.style.minHeight = `${tallest}px`;
  }).observe(element);
}

/**
 * Sends a request; what the server refuses comes back.
 * @param {string} path
 * @param {unknown} body
 * @returns {Promise<import("./messages").Refusal | null>}
 */
export async function send(path, body) {
  try {
    const answer = await fetch(path, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) });
    if (answer.ok) return null;
    const kind = answer.headers.get("content-type") ?? "";
    if (kind.startsWith("application/json")) return await answer.json();
    return { message: (await answer.text()).trim() || `the server answers ${answer.status}`, problems: [] };
  } catch {
    return { message: "the panel does not answer: is it still running?", problems: [] };
  }
}

/**
 * Gives a table these rows, told apart by `data-key`. What is the same stays the same element: a press on a button and the focus are
 * not lost when a number beside them changes.
 * @param {HTMLTableElement} table
 * @param {HTMLTableRowElement[]} rows
 */
export function settle(table, rows) {
  const body = table.tBodies[0];
  const known = new Map([...body.rows].map((row) => [row.dataset.key, row]));
  rows.forEach((row, k) => {
    const kept = known.get(row.dataset.key);
    if (kept) take(kept, row);
    const next = kept ?? row;
    if (body.rows[k] !== next) body.insertBefore(next, body.rows[k] ?? null);
  });
  while (body.rows.length > rows.length) body.rows[rows.length].remove();
}

/**
 * What differs in a row of the same key.
 * @param {HTMLTableRowElement} kept
 * @param {HTMLTableRowElement} row
 */
function take(kept, row) {
  for (const { name, value } of row.attributes) kept.setAttribute(name, value);
  [...row.cells].forEach((cell, k) => {
    if (!kept.cells[k].isEqualNode(cell)) kept.cells[k].replaceWith(cell);
  });
}
