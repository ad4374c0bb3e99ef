// The border between two renders that lie over each other: dragged, or moved by keys.

import { box } from "./dom.js";
import { clamp } from "./view.js";

/** @import { Stage } from "./stage.js" */

/** The steps of the border by each key, as a share of the width. */
const KEYS = new Map([
  ["ArrowLeft", -0.02],
  ["ArrowDown", -0.02],
  ["ArrowRight", 0.02],
  ["ArrowUp", 0.02],
  ["PageDown", -0.2],
  ["PageUp", 0.2],
  ["Home", -1],
  ["End", 1],
]);

/**
 * Lets the border be moved.
 * @param {Stage} stage
 */
export function connectDivider(stage) {
  const divider = box("divider");
  const put = (/** @type {number} */ share) => {
    stage.divide = clamp(share, 0, 1);
    stage.redraw();
  };
  divider.addEventListener("pointerdown", (event) => {
    divider.setPointerCapture(event.pointerId);
    event.stopPropagation();
  });
  divider.addEventListener("pointermove", (event) => {
    if (!divider.hasPointerCapture(event.pointerId)) return;
    event.stopPropagation();
    const { left, width } = stage.element.getBoundingClientRect();
    put((event.clientX - left) / width);
  });
  divider.addEventListener("keydown", (event) => {
    const by = KEYS.get(event.key);
    if (by === undefined) return;
    event.preventDefault();
    put(stage.divide + by);
  });
}

/**
 * Shows the border where it is.
 * @param {Stage} stage
 */
export function placeDivider(stage) {
  const divider = box("divider");
  const isSplit = Boolean(stage.picture?.frame("b"));
  divider.hidden = !isSplit;
  const share = Math.round(100 * stage.divide);
  divider.style.left = `${100 * stage.divide}%`;
  divider.setAttribute("aria-valuenow", String(share));
  divider.setAttribute("aria-valuetext", `a has ${share} percent of the width`);
}
