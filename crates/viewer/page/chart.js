// The curves of errors, drawn.

import { FRAME, line, plot, usable } from "./curves.js";
import { box, draw, make } from "./dom.js";
import { compact, percent } from "./format.js";

/** @import { Plot } from "./curves.js" */
/** @import { Lane } from "./types.js" */

/** @param {Lane[]} lanes */
export function showCurves(lanes) {
  const chart = box("chart");
  const made = plot(lanes.map((lane) => lane.curve));
  if (!made) {
    chart.replaceChildren(make("p", { class: "hint" }, ["No estimate yet: it takes a few passes."]));
    return;
  }
  const { width, height } = FRAME;
  const label = lanes.map((lane) => `${lane.lane}, ${lane.integrator}: ${percent(lane.relativeError)}`).join("; ");
  const svg = draw("svg", {
    viewBox: `0 0 ${width} ${height}`,
    role: "img",
    "aria-label": `Relative error against seconds, both logarithmic. Now ${label}`,
  });
  svg.append(...axes(made), ...lanes.flatMap((lane) => curve(made, lane)), ...names(lanes));
  chart.replaceChildren(svg);
}

/** @param {Plot} made */
function axes(made) {
  const { width, height, left, right, top, bottom } = FRAME;
  const floor = height - bottom;
  const columns = made.x.marks.flatMap((mark) => {
    const [x] = made.place([mark, made.y.low]);
    return [
      draw("line", { class: "grid", x1: x, x2: x, y1: top, y2: floor }),
      draw("text", { x, y: floor + 14, "text-anchor": "middle" }, [compact(mark)]),
    ];
  });
  const rows = made.y.marks.flatMap((mark) => {
    const [, y] = made.place([made.x.low, mark]);
    return [
      draw("line", { class: "grid", x1: left, x2: width - right, y1: y, y2: y }),
      draw("text", { x: left - 6, y: y + 4, "text-anchor": "end" }, [percent(mark)]),
    ];
  });
  const title = draw("text", { x: (left + width - right) / 2, y: height - 4, "text-anchor": "middle" }, ["seconds"]);
  return [...columns, ...rows, title];
}

/**
 * @param {Plot} made
 * @param {Lane} lane
 */
function curve(made, lane) {
  const points = usable(lane.curve);
  const last = points.at(-1);
  if (!last) return [];
  const [cx, cy] = made.place(last);
  return [
    draw("polyline", { class: `curve ${lane.lane}`, points: line(made, points) }),
    draw("circle", { class: `dot ${lane.lane}`, cx, cy, r: 3 }),
  ];
}

/**
 * Names in the upper right corner, where errors that fall leave room.
 * @param {Lane[]} lanes
 */
function names(lanes) {
  const { width, right, top } = FRAME;
  return lanes.map(({ lane, integrator, shadowRays }, i) => {
    const place = { x: width - right, y: top + 10 + 15 * i, "text-anchor": "end" };
    return draw("text", { class: lane, ...place }, [`${lane} ${integrator}, ${shadowRays}`]);
  });
}
