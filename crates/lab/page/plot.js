// Plots as drawings. All is an attribute of its element and black is `currentColor`: a drawing that is
// copied out of the page looks the same, and one in a dark page can be read.

import { fraction, hasPlace, ruler } from "./axis.js";
import { draw } from "./dom.js";
import { number } from "./number.js";

/** @import { Ruler } from "./axis.js" */
/** @import { Plot, Series } from "./results.js" */

/** @typedef {[number, number]} Place Unit: pixels of the drawing. */

/** @typedef {{width: number, height: number}} Size Of the whole, and of the part between the axes. */

/** @typedef {{x: Ruler, y: Ruler, left: number, right: number, top: number, bottom: number}} Frame */

/** Colours that colour-blind readers distinguish, too [Okabe08]; its yellow is too pale for lines. */
const COLORS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "currentColor"];

/** Markers around the origin, of about the same area. */
const MARKERS = [
  "M4 0A4 4 0 1 1 -4 0A4 4 0 1 1 4 0Z",
  "M-3.6 -3.6H3.6V3.6H-3.6Z",
  "M0 -5L4.6 3.4H-4.6Z",
  "M0 -5L5 0L0 5L-5 0Z",
  "M0 5L4.6 -3.4H-4.6Z",
  "M-4 -4L4 4M-4 4L4 -4",
  "M0 -5V5M-5 0H5",
  "M-4.6 -2.2H4.6V2.2H-4.6Z",
];

/** Dashes; the numbers of colours, markers and dashes have no common divisor, so all 280 series differ. */
const DASHES = ["none", "7 3", "2 3", "9 3 2 3", "14 4"];

export const LARGE = { width: 680, height: 300 };
export const SMALL = { width: 340, height: 150 };

const TOP = 12;
const RIGHT = 16;
/** Room below for the ticks and the label of the axis. */
const BELOW = 48;
/** The mean width of a letter. */
const LETTER = 6.8;
/** Of more points than this, intervals are a band. */
const MOST_BARS = 24;
/** The height of a line of the legend, and the room for the piece of line before a name. */
const [ROW, SAMPLE] = [20, 44];

/**
 * The right edge of a histogram's last bin, which is as wide as the one before it.
 * @param {Series} series
 */
function lastEdge({ points }) {
  const [before, last] = points.slice(-2).map(([x]) => x ?? NaN);
  if (points.length === 0) return NaN;
  return last === undefined ? before + 1 : last + (last - before);
}

/**
 * The ranges of the values of a plot. Null: no point has a place on both axes.
 * @param {Plot} plot
 * @param {Size} size
 * @returns {Frame | null}
 */
export function frameOf({ kind, x, y, series }, size) {
  const isHistogram = kind === "histogram";
  const xs = series.flatMap((one) => [...one.points.map(([x]) => x), ...(isHistogram ? [lastEdge(one)] : [])]);
  const ys = series.flatMap(({ points, intervals }) => [...points.map(([, y]) => y), ...intervals.flat()]);
  const across = ruler(x.scale, xs);
  // A histogram stands on the axis.
  const upwards = ruler(y.scale, isHistogram ? [...ys, 0] : ys);
  if (!across || !upwards) return null;
  const letters = Math.max(0, ...upwards.ticks.map(({ label }) => label.length));
  const left = 34 + LETTER * letters;
  return { x: across, y: upwards, left, right: size.width - RIGHT, top: TOP, bottom: TOP + size.height };
}

/**
 * The place of a point; a point beyond an end is at the end.
 * @param {Frame} frame
 * @param {Place} point
 * @returns {Place}
 */
export function place({ x, y, left, right, top, bottom }, point) {
  return [left + (right - left) * fraction(x, point[0]), bottom - (bottom - top) * fraction(y, point[1])];
}

/**
 * The points that have a place on both axes.
 * @param {Frame} frame
 * @param {Series} series
 */
function shown({ x, y }, { points }) {
  const isShown = (/** @type {[number | null, number | null]} */ point) => hasPlace(x.scale, point[0]) && hasPlace(y.scale, point[1]);
  return /** @type {Place[]} */ (points.filter(isShown));
}

/**
 * The number of points that cannot be drawn. Empty bins are drawn, as nothing.
 * @param {Plot} plot
 * @param {Frame} frame
 */
export function leftOut({ kind, series }, frame) {
  const isShown = (/** @type {[number | null, number | null]} */ [x, y]) =>
    hasPlace(frame.x.scale, x) && hasPlace(kind === "lines" ? frame.y.scale : "linear", y);
  return series.flatMap(({ points }) => points).filter((point) => !isShown(point)).length;
}

/**
 * The drawing of a plot.
 * @param {Plot} plot
 * @param {Frame} frame
 * @param {Size} size
 */
export function drawing(plot, frame, size) {
  const [legend, legendHeight] = legendOf(plot, frame.bottom + BELOW, size.width);
  const series = plot.series.map((one, index) =>
    group(index, "series", [draw("title", {}, [one.name]), ...(plot.kind === "lines" ? curve(one, index, frame) : steps(one, index, frame))]),
  );
  return draw(
    "svg",
    {
      viewBox: `0 0 ${size.width} ${frame.bottom + BELOW + legendHeight}`,
      role: "img",
      "aria-label": `${plot.caption} ${inWords(plot)}`,
      "font-family": "system-ui, sans-serif",
      "font-size": 12,
      fill: "currentColor",
    },
    [...grid(plot, frame), ...series, ...legend],
  );
}

/**
 * Describes the drawing, for people who do not see it.
 * @param {Plot} plot
 */
function inWords({ x, y, series }) {
  const written = (/** @type {[number | null, number | null] | undefined} */ point) =>
    point ? `(${number(point[0])}, ${number(point[1])})` : "";
  const ends = series.map(({ name, points }) => `${name}: ${points.length} points from ${written(points[0])} to ${written(points.at(-1))}.`);
  return `${y.label} over ${x.label}. ${ends.join(" ")}`;
}

/**
 * Lines at the ticks, what is written beside them, and the labels of the axes.
 * @param {Plot} plot
 * @param {Frame} frame
 */
function grid(plot, frame) {
  const { x, y, left, right, top, bottom } = frame;
  const at = (/** @type {number} */ a, /** @type {number} */ b) => place(frame, [a, b]);
  const vertical = (/** @type {number} */ value, /** @type {number} */ opacity) => rule(`M${at(value, 0)[0].toFixed(1)} ${top}V${bottom}`, opacity);
  const horizontal = (/** @type {number} */ value, /** @type {number} */ opacity) => rule(`M${left} ${at(0, value)[1].toFixed(1)}H${right}`, opacity);
  const middle = top + 0.5 * (bottom - top);
  return [
    ...x.minor.map((value) => vertical(value, 0.07)),
    ...y.minor.map((value) => horizontal(value, 0.07)),
    ...x.ticks.map(({ value }) => vertical(value, 0.2)),
    ...y.ticks.map(({ value }) => horizontal(value, 0.2)),
    rule(`M${left} ${top}V${bottom}H${right}`, 0.8),
    ...x.ticks.map(({ value, label }) => words([at(value, 0)[0], bottom + 16], "middle", label)),
    ...y.ticks.map(({ value, label }) => words([left - 6, at(0, value)[1] + 4], "end", label)),
    words([0.5 * (left + right), bottom + 36], "middle", plot.x.label),
    draw("text", { x: 14, y: middle, "text-anchor": "middle", transform: `rotate(-90 14 ${middle})` }, [plot.y.label]),
  ];
}

/**
 * @param {string} d
 * @param {number} opacity
 */
function rule(d, opacity) {
  return draw("path", { d, fill: "none", stroke: "currentColor", "stroke-opacity": opacity });
}

/**
 * @param {Place} at
 * @param {"middle" | "start" | "end"} anchor
 * @param {string} text
 */
function words([x, y], anchor, text) {
  return draw("text", { x: x.toFixed(1), y: y.toFixed(1), "text-anchor": anchor }, [text]);
}

/**
 * @param {number} index
 * @param {"series" | "sample"} kind
 * @param {(SVGElement | string)[]} children
 */
function group(index, kind, children) {
  return draw("g", { class: `${kind} series-${index}`, color: COLORS[index % COLORS.length] }, children);
}

/**
 * @param {number} index
 * @param {string} d
 */
function stroke(index, d) {
  const dashes = DASHES[index % DASHES.length];
  return draw("path", { d, fill: "none", stroke: "currentColor", "stroke-width": 2, "stroke-linejoin": "round", "stroke-dasharray": dashes });
}

/**
 * @param {number} index
 * @param {Place} at
 */
function marker(index, [x, y]) {
  const transform = `translate(${x.toFixed(1)} ${y.toFixed(1)})`;
  const d = MARKERS[index % MARKERS.length];
  return draw("path", { class: "point", d, transform, fill: "currentColor", stroke: "currentColor", "stroke-width": 1.5 });
}

/**
 * @param {string} d
 * @param {number} opacity
 */
function area(d, opacity) {
  return draw("path", { d, fill: "currentColor", "fill-opacity": opacity });
}

/** @param {Place[]} places */
function polyline(places) {
  return places.map(([x, y], i) => `${i === 0 ? "M" : "L"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
}

/**
 * Points joined by lines, with the intervals of those that have one.
 * @param {Series} series
 * @param {number} index
 * @param {Frame} frame
 */
function curve(series, index, frame) {
  const places = shown(frame, series).map((point) => place(frame, point));
  const intervals = series.points.length > MOST_BARS ? band(series, frame) : bars(series, frame, 0);
  const markers = places.length > 4 * MOST_BARS ? [] : places.map((at) => marker(index, at));
  return [intervals, stroke(index, polyline(places)), ...markers];
}

/**
 * Steps from the axis to the heights of the bins, with the intervals in the middle of each.
 * @param {Series} series
 * @param {number} index
 * @param {Frame} frame
 */
function steps(series, index, frame) {
  const edges = [...series.points.map(([x]) => x ?? NaN), lastEdge(series)];
  const corners = series.points.flatMap(([, height], i) => [edges[i], edges[i + 1]].map((x) => place(frame, [x, height ?? 0])));
  const across = corners.map(([x]) => x);
  const outline = polyline([[across[0] ?? 0, frame.bottom], ...corners, [across.at(-1) ?? 0, frame.bottom]]);
  return [area(outline, 0.1), stroke(index, outline), bars(series, frame, 0.5 * ((across[1] ?? 0) - (across[0] ?? 0)))];
}

/**
 * The ends of the intervals of all points that have a place.
 * @param {Series} series
 * @param {Frame} frame
 * @returns {[Place, Place][]}
 */
function ends({ points, intervals }, frame) {
  return intervals.flatMap(([low, high], i) => {
    const [x, y] = points[i];
    if (!hasPlace(frame.x.scale, x) || !hasPlace(frame.y.scale, y) || low === null || high === null) return [];
    return [/** @type {[Place, Place]} */ ([place(frame, [x, low]), place(frame, [x, high])])];
  });
}

/**
 * A bar with caps for each interval, moved to the right.
 * @param {Series} series
 * @param {Frame} frame
 * @param {number} by
 */
function bars(series, frame, by) {
  const bar = (/** @type {[Place, Place]} */ [low, high]) => {
    const [left, middle, right] = [-4, 0, 4].map((step) => (low[0] + by + step).toFixed(1));
    const [a, b] = [low[1].toFixed(1), high[1].toFixed(1)];
    return `M${left} ${a}H${right}M${left} ${b}H${right}M${middle} ${a}V${b}`;
  };
  const d = ends(series, frame).map(bar).join("");
  return draw("path", { d, fill: "none", stroke: "currentColor", "stroke-width": 1.2 });
}

/**
 * The area between the lower and the upper ends.
 * @param {Series} series
 * @param {Frame} frame
 */
function band(series, frame) {
  const both = ends(series, frame);
  return area(polyline([...both.map(([low]) => low), ...both.map(([, high]) => high).reverse()]), 0.2);
}

/**
 * The legend from `top` downwards, and its height.
 * @param {Plot} plot
 * @param {number} top
 * @param {number} width
 * @returns {[SVGElement[], number]}
 */
function legendOf({ kind, series }, top, width) {
  const left = 34;
  let [x, row] = [left, 0];
  const entries = series.map(({ name }, index) => {
    const own = SAMPLE + LETTER * name.length + 12;
    if (x > left && x + own > width) [x, row] = [left, row + 1];
    const [at, y] = [x, top + ROW * (row + 0.5)];
    x += own;
    const point = kind === "lines" ? [marker(index, [at + 16, y])] : [];
    const sample = group(index, "sample", [stroke(index, `M${at} ${y}h32`), ...point]);
    return draw("g", {}, [sample, words([at + SAMPLE - 6, y + 4], "start", name)]);
  });
  return [entries, series.length === 0 ? 4 : ROW * (row + 1) + 4];
}
