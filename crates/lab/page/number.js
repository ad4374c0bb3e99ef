// Numbers for people who compare: as many digits as mean something.

const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/**
 * A number with at most four significant digits; whole numbers below ten millions have all of theirs.
 * @param {number | null} value
 */
export function number(value) {
  if (value === null || Number.isNaN(value)) return "no number";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const magnitude = exponent(value);
  if (Number.isInteger(value) && magnitude < 7) return withDecimals(value, 0);
  if (magnitude < -4 || magnitude >= 6) return scientific(value);
  return grouped(shortened(value.toFixed(Math.max(0, 3 - magnitude))));
}

/**
 * A number with exactly so many decimals.
 * @param {number} value
 * @param {number} decimals
 */
export function withDecimals(value, decimals) {
  return grouped(value.toFixed(decimals));
}

/**
 * A number and its interval, `0.85 [0.82, 0.88]`.
 *
 * The last digit is the first in which the interval has at least five steps; very large and very
 * small numbers share one power of ten.
 * @param {number | null} value
 * @param {number | null} low
 * @param {number | null} high
 */
export function interval(value, low, high) {
  const ends = [value ?? NaN, low ?? NaN, high ?? NaN];
  const width = ends[2] - ends[1];
  if (!Number.isFinite(ends[0]) || !Number.isFinite(width) || width <= 0) {
    return `${number(value)} [${number(low)}, ${number(high)}]`;
  }
  const largest = exponent(Math.max(...ends.map(Math.abs)));
  // An interval of a millionth of its value needs no more digits.
  const last = Math.max(exponent(width / 5), largest - 7);
  const isPlain = largest >= -4 && largest < 6;
  const shift = isPlain ? 0 : largest;
  const [middle, ...bounds] = ends.map((end) => withDecimals(shifted(end, -shift), Math.max(0, shift - last)));
  return `${middle} [${bounds.join(", ")}]${isPlain ? "" : ` ·${powerOfTen(largest)}`}`;
}

/**
 * 10ⁿ.
 * @param {number} n
 */
export function powerOfTen(n) {
  const digits = [...String(n)].map((digit) => (digit === "-" ? "⁻" : RAISED[Number(digit)]));
  return `10${digits.join("")}`;
}

/**
 * The power of ten of the first digit; 0 for 0.
 * @param {number} value
 */
export function exponent(value) {
  return Number(value.toExponential().split("e")[1]);
}

/**
 * `value · 10^power`, rounded once, as a reader of digits does.
 * @param {number} value
 * @param {number} power
 */
export function shifted(value, power) {
  return power < 0 ? value / 10 ** -power : value * 10 ** power;
}

/** @param {number} value */
function scientific(value) {
  const [digits, power] = value.toExponential(3).split("e");
  return `${grouped(shortened(digits))}·${powerOfTen(Number(power))}`;
}

/**
 * Decimals without the zeros at their end.
 * @param {string} written
 */
function shortened(written) {
  return written.includes(".") ? written.replace(/\.?0+$/, "") : written;
}

/**
 * With a minus sign, and a narrow space between thousands where there are five digits or more.
 * @param {string} written
 */
function grouped(written) {
  const digits = written.replace("-", "");
  const sign = written !== digits && /[1-9]/.test(digits) ? "−" : "";
  const [whole, decimals] = digits.split(".");
  const spaced = whole.length < 5 ? whole : whole.replace(/\B(?=(\d{3})+$)/g, "\u202f");
  return `${sign}${spaced}${decimals === undefined ? "" : `.${decimals}`}`;
}
