// Where curves of errors are drawn: both axes logarithmic, marks at 1, 2 and 5 or at powers of ten.

/** @typedef {[number, number]} Point */

/** @typedef {{low: number, high: number, marks: number[]}} Axis Values, not logarithms. */

/**
 * @typedef {object} Plot
 * @property {Axis} x
 * @property {Axis} y
 * @property {(point: Point) => Point} place From values to the drawing.
 */

/** The drawing: its size, and what its axes take. */
export const FRAME = { width: 340, height: 200, left: 46, right: 12, top: 10, bottom: 34 };

/**
 * Marks of a logarithmic axis: at least two, at most about six.
 * @param {number} low
 * @param {number} high
 */
export function ticks(low, high) {
  const from = Math.floor(Math.log10(low));
  const to = Math.ceil(Math.log10(high));
  const decades = Math.max(1, to - from);
  const steps = decades <= 2 ? [1, 2, 5] : [1];
  const stride = decades > 6 ? Math.ceil(decades / 6) : 1;
  const all = [];
  for (let power = from; power <= to; power += stride) {
    for (const step of steps) all.push(step * 10 ** power);
  }
  const slack = 1e-9;
  return all.map((mark) => Number(mark.toPrecision(3))).filter((mark) => mark >= low * (1 - slack) && mark <= high * (1 + slack));
}

/**
 * An axis that has all values, and at least a factor of two.
 * @param {number[]} values
 * @returns {Axis}
 */
export function axis(values) {
  let low = Math.min(...values);
  let high = Math.max(...values);
  if (high < 2 * low) [low, high] = [low / Math.SQRT2, high * Math.SQRT2];
  const marks = ticks(low, high);
  if (marks.length >= 2) return { low, high, marks };
  // Wider, up to the next marks.
  const wide = ticks(low / 2.5, high * 2.5);
  return { low: Math.min(low, wide[0]), high: Math.max(high, wide[wide.length - 1]), marks: wide };
}

/**
 * What logarithms can show: times and errors that are positive.
 * @param {Point[]} curve
 */
export function usable(curve) {
  return curve.filter(([x, y]) => x > 0 && y > 0 && Number.isFinite(x) && Number.isFinite(y));
}

/**
 * The plot that has all curves; null where there is nothing to show.
 * @param {Point[][]} curves
 * @returns {Plot | null}
 */
export function plot(curves) {
  const points = curves.flatMap(usable);
  if (points.length === 0) return null;
  const x = axis(points.map((point) => point[0]));
  const y = axis(points.map((point) => point[1]));
  const { width, height, left, right, top, bottom } = FRAME;
  const share = (/** @type {Axis} */ { low, high }, /** @type {number} */ value) =>
    Math.log(value / low) / Math.log(high / low);
  return {
    x,
    y,
    place: ([a, b]) => [
      left + share(x, a) * (width - left - right),
      height - bottom - share(y, b) * (height - top - bottom),
    ],
  };
}

/**
 * The points of a polyline.
 * @param {Plot} plot
 * @param {Point[]} curve
 */
export function line(plot, curve) {
  return usable(curve)
    .map((point) => plot.place(point).map((at) => at.toFixed(1)).join(","))
    .join(" ");
}
