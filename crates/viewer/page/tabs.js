// Tabs, as the pattern of ARIA has them: one of them is in the order of the tabulator, arrows choose.

import { box } from "./dom.js";

const KEYS = new Map([
  ["ArrowLeft", -1],
  ["ArrowRight", 1],
]);

/**
 * Connects the tabs.
 * @param {() => void} onChange
 */
export function connectTabs(onChange) {
  const tabs = all();
  tabs.forEach((tab, i) => {
    tab.addEventListener("click", () => {
      showTab(tab.id);
      onChange();
    });
    tab.addEventListener("keydown", (event) => {
      const by = KEYS.get(event.key);
      if (by === undefined) return;
      event.preventDefault();
      const next = tabs[(i + by + tabs.length) % tabs.length];
      next.focus();
      next.click();
    });
  });
}

/** @param {string} id Of the tab. */
export function showTab(id) {
  for (const tab of all()) {
    const isShown = tab.id === id;
    tab.setAttribute("aria-selected", String(isShown));
    tab.tabIndex = isShown ? 0 : -1;
    box(tab.getAttribute("aria-controls") ?? "").hidden = !isShown;
  }
}

/** @returns {HTMLElement[]} */
function all() {
  return [...box("tabs").querySelectorAll("button")];
}
