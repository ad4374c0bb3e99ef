// The curves of errors, drawn.

import { box, make } from "./dom.js";
import { SMALL, drawing, frameOf } from "./plot.js";

/** @import { Plot } from "./results.js" */
/** @import { Lane } from "./types.js" */

/** @param {Lane[]} lanes */
export function showCurves(lanes) {
  const plot = plotOf(lanes);
  const frame = frameOf(plot, SMALL);
  const chart = box("chart");
  if (frame) chart.replaceChildren(drawing(plot, frame, SMALL));
  else chart.replaceChildren(make("p", { class: "hint" }, ["No estimate yet: it takes a few passes."]));
}

/**
 * @param {Lane[]} lanes
 * @returns {Plot}
 */
function plotOf(lanes) {
  const series = lanes.map(({ lane, integrator, shadowRays, curve }) => {
    const points = curve.map(([seconds, error]) => /** @type {[number, number]} */ ([seconds, 100 * error]));
    return { name: `${lane} ${integrator}, ${shadowRays}`, points, intervals: [] };
  });
  return {
    caption: "Relative error over seconds.",
    kind: "lines",
    x: { label: "seconds", scale: "log" },
    y: { label: "%", scale: "log" },
    series,
  };
}
