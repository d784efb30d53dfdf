// The workbench: load recordings, compare, explain, adopt. Its tab is shown when `ready` says so.

/** Whether there is anything to show. */
export const ready = false;

/**
 * Fills the tab when it is opened for the first time.
 * @param {HTMLElement} view
 */
export function start(view) {
  view.replaceChildren();
}
