// The range of an axis, and where its ticks are.

import { exponent, number, powerOfTen, shifted, withDecimals } from "./number.js";

/** @import { Scale } from "./results.js" */

/** @typedef {{value: number, label: string}} Tick */

/**
 * An axis with its range and its ticks; `minor` are lines between those.
 * @typedef {{scale: Scale, low: number, high: number, ticks: Tick[], minor: number[]}} Ruler
 */

/** The share of a range that is left free at each end. */
const MARGIN = 0.04;

/**
 * True if a value has a place on such an axis.
 * @param {Scale} scale
 * @param {number | null} value
 * @returns {value is number}
 */
export function hasPlace(scale, value) {
  return value !== null && Number.isFinite(value) && (scale === "linear" || value > 0);
}

/**
 * An axis on which all values have a place that can have one. Null: there are none.
 * @param {Scale} scale
 * @param {(number | null)[]} values
 * @returns {Ruler | null}
 */
export function ruler(scale, values) {
  const [low, high] = values.reduce(
    ([low, high], value) => (hasPlace(scale, value) ? [Math.min(low, value), Math.max(high, value)] : [low, high]),
    [Infinity, -Infinity],
  );
  if (low > high) return null;
  return scale === "linear" ? linear(low, high) : logarithmic(low, high);
}

/**
 * The place of a value, in [0, 1]; a value beyond an end is at the end.
 * @param {Ruler} ruler
 * @param {number} value
 */
export function fraction({ scale, low, high }, value) {
  if (scale === "log" && value <= 0) return 0;
  const share = scale === "linear" ? (value - low) / (high - low) : Math.log(value / low) / Math.log(high / low);
  return Math.min(Math.max(share, 0), 1);
}

/**
 * @param {number} low
 * @param {number} high
 * @returns {Ruler}
 */
function linear(low, high) {
  const margin = high > low ? MARGIN * (high - low) : 0.1 * Math.max(Math.abs(low), 1);
  // No margin shows negative numbers where there are none.
  const start = low >= 0 ? Math.max(low - margin, 0) : low - margin;
  const end = high + margin;
  return { scale: "linear", low: start, high: end, ticks: multiplesOfStep((end - start) / 6, start, end), minor: [] };
}

/**
 * @param {number} low
 * @param {number} high
 * @returns {Ruler}
 */
function logarithmic(low, high) {
  const margin = 10 ** Math.max(MARGIN * Math.log10(high / low), 0.05);
  [low, high] = [low / margin, high * margin];
  const decades = Math.log10(high / low);
  const ticks = decades < 1 ? multiplesOfStep((high - low) / 5, low, high) : powers(low, high, decades);
  const minor = decades < 8 ? multiples(low, high, [2, 3, 4, 5, 6, 7, 8, 9]) : [];
  return { scale: "log", low, high, ticks, minor: minor.map(([digit, power]) => shifted(digit, power)) };
}

/**
 * Powers of ten, at most about eight of them, and where they are few their multiples by 2 and 5.
 * @param {number} low
 * @param {number} high
 * @param {number} decades
 * @returns {Tick[]}
 */
function powers(low, high, decades) {
  const every = Math.ceil(decades / 8);
  // One way of writing for the whole axis.
  const isShort = low >= 1e-3 && high < 1e5;
  const label = (/** @type {number} */ digit, /** @type {number} */ power) => {
    if (isShort || power === 0 || power === 1) return number(shifted(digit, power));
    return digit > 1 ? `${digit}·${powerOfTen(power)}` : powerOfTen(power);
  };
  return multiples(low, high, decades < 3 ? [1, 2, 5] : [1])
    .filter(([, power]) => power % every === 0)
    .map(([digit, power]) => ({ value: shifted(digit, power), label: label(digit, power) }));
}

/**
 * All numbers of a range that have one of these digits and zeros, as digit and power of ten.
 * @param {number} low
 * @param {number} high
 * @param {number[]} digits
 */
function multiples(low, high, digits) {
  /** @type {[number, number][]} */
  const found = [];
  for (let power = exponent(low); power <= exponent(high); power++) {
    for (const digit of digits) found.push([digit, power]);
  }
  const isInside = (/** @type {number} */ value) => value >= low && value <= high;
  return found.filter(([digit, power]) => isInside(shifted(digit, power)));
}

/**
 * All multiples in a range of the smallest step, of 1, 2 or 5 times a power of ten, that is at least `size`.
 * @param {number} size
 * @param {number} low
 * @param {number} high
 * @returns {Tick[]}
 */
function multiplesOfStep(size, low, high) {
  const first = exponent(size);
  const digit = [1, 2, 5].find((digit) => size <= shifted(digit, first)) ?? 10;
  const [step, power] = digit === 10 ? [1, first + 1] : [digit, first];
  const label = (/** @type {number} */ value) =>
    power >= -4 && power <= 6 ? withDecimals(value, Math.max(0, -power)) : number(value);
  const [begin, end] = [Math.ceil(low / shifted(step, power)), Math.floor(high / shifted(step, power))];
  return Array.from({ length: end - begin + 1 }, (_, i) => {
    const value = shifted((begin + i) * step, power);
    return { value, label: label(value) };
  });
}
