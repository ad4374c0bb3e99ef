// Numbers as people read them.

/**
 * Three or four digits and a letter: 950, 12.3 k, 4.56 M.
 * @param {number} value
 */
export function compact(value) {
  if (!Number.isFinite(value)) return "–";
  const units = ["", " k", " M", " G", " T"];
  let unit = 0;
  while (Math.abs(value) >= 999.5 && unit < units.length - 1) {
    value /= 1000;
    unit += 1;
  }
  return `${digits(value, 3)}${units[unit]}`;
}

/**
 * So many significant digits, without zeros at the end.
 * @param {number | null} value
 * @param {number} count
 */
export function digits(value, count) {
  if (value === null || !Number.isFinite(value)) return "–";
  return String(Number(value.toPrecision(count)));
}

/**
 * Nine digits: enough to distinguish any two floats.
 * @param {number} value
 */
export function exact(value) {
  return digits(value, 9);
}

/**
 * A share as percent.
 * @param {number | null} share
 */
export function percent(share) {
  return share === null || !Number.isFinite(share) ? "–" : `${digits(100 * share, 3)} %`;
}

/**
 * A time as 4.2 s, 3:07 min or 2:05 h.
 * @param {number | null} seconds
 */
export function duration(seconds) {
  if (seconds === null || !Number.isFinite(seconds)) return "–";
  if (seconds < 59.95) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  if (whole < 3600) return `${Math.floor(whole / 60)}:${two(whole % 60)} min`;
  const minutes = Math.round(seconds / 60);
  return `${Math.floor(minutes / 60)}:${two(minutes % 60)} h`;
}

/** @param {number} value */
function two(value) {
  return String(value).padStart(2, "0");
}

/**
 * A value for a small cell: at most eight characters.
 * @param {number} value
 */
export function cell(value) {
  const size = Math.abs(value);
  if (value === 0) return "0";
  if (size >= 1e-3 && size < 1e4) return digits(value, 4);
  return value.toExponential(1);
}

/**
 * A number of things, of which one is one.
 * @param {number} number
 * @param {string} thing
 */
export function count(number, thing) {
  const several = thing.endsWith("s") ? `${thing}es` : `${thing}s`;
  return `${number} ${number === 1 ? thing : several}`;
}

/**
 * Luminance of linear Rec. 709.
 * @param {ArrayLike<number>} color
 */
export function luminance(color) {
  return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
}
