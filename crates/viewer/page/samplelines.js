// The drawing of a sample: lines on the film, from the data of the server.

import { luminance } from "./format.js";

/** @import { SampleReport, SampleSubpath, SampleTerm } from "./types.js" */
/** @import { Point } from "./view.js" */

/** @typedef {"chosen" | "blocked" | "left" | "splat"} Fate */

/**
 * A line between two points of the film. Its width shows the value, its opacity the probability.
 * @typedef {object} Ray
 * @property {string} name
 * @property {Fate} fate
 * @property {Point} from The light's side.
 * @property {Point} to
 * @property {number} width Unit: CSS pixels.
 * @property {number} opacity
 */

/** The thinnest line and the thickest. */
const WIDTHS = [1.5, 6];
/** The faintest line: it can still be seen. */
const FAINTEST = 0.35;

/**
 * The fate of a candidate.
 * @param {{is_chosen: boolean, is_visible: boolean}} candidate
 * @returns {Fate}
 */
export function fate({ is_chosen: isChosen, is_visible: isVisible }) {
  if (!isChosen) return "left";
  return isVisible ? "chosen" : "blocked";
}

/**
 * A line's width: by the cube root, so that small values are seen beside large ones.
 * @param {SampleTerm} term
 * @param {number} greatest
 */
export function width(term, greatest) {
  const share = greatest > 0 ? Math.cbrt(luminance(term.value) / greatest) : 0;
  return WIDTHS[0] + Math.min(Math.max(share, 0), 1) * (WIDTHS[1] - WIDTHS[0]);
}

/** @param {number} prob */
export function opacity(prob) {
  return FAINTEST + (1 - FAINTEST) * Math.min(Math.max(prob, 0), 1);
}

/** @param {SampleTerm[]} terms */
export function greatest(terms) {
  return Math.max(0, ...terms.map((term) => luminance(term.value)));
}

/**
 * The connections that have both ends in sight of the film's plane.
 * @param {SampleReport} report
 * @returns {Ray[]}
 */
export function rays(report) {
  const most = greatest(report.candidates);
  return report.candidates.flatMap((candidate, i) => {
    const from = candidate.light_end.raster;
    const to = report.camera.vertices[candidate.t - 1]?.raster;
    if (!from || !to) return [];
    const style = { width: width(candidate, most), opacity: opacity(candidate.prob) };
    return [{ name: `candidate-${i}`, fate: fate(candidate), from, to, ...style }];
  });
}

/**
 * A subpath in pieces: it is interrupted where a vertex is behind the camera. The camera subpath
 * begins with the pixel itself, since the lens is nowhere on the film.
 * @param {SampleSubpath} subpath
 * @returns {Point[][]}
 */
export function pieces(subpath) {
  /** @type {Point[][]} */
  const all = [[]];
  for (const vertex of subpath.vertices) {
    if (vertex.raster && !vertex.is_infinite) all[all.length - 1].push(vertex.raster);
    else if (all[all.length - 1].length > 0) all.push([]);
  }
  return all.filter((piece) => piece.length > 0);
}

/**
 * Vertices with the names that strategies count by: z_1 is the first behind the lens, y_0 is on the light.
 * @param {SampleSubpath} subpath
 * @param {string} letter
 */
export function names(subpath, letter) {
  return subpath.vertices.flatMap(({ raster }, i) => (raster ? [{ name: `${letter}${subscript(i)}`, at: raster }] : []));
}

/** @param {number} number */
function subscript(number) {
  return [...String(number)].map((digit) => String.fromCharCode(0x2080 + Number(digit))).join("");
}
