// Pixels as the pages hold them: floats, of frames that a film has, and of half floats in base64.

/** @typedef {"a" | "b"} LaneName One of at most two images that are shown side by side. */

/**
 * @typedef {object} Frame
 * @property {LaneName} lane
 * @property {[number, number]} resolution Of the film that the frame is a part of.
 * @property {[number, number]} origin Of the crop on that film.
 * @property {[number, number]} size Of the crop.
 * @property {Float32Array} channels Three for each pixel of the crop.
 */

/**
 * The value that a frame has at a pixel of a film of another resolution, such as the whole one's
 * while the frame is a preview. Null outside.
 * @param {Frame} frame
 * @param {[number, number]} resolution
 * @param {[number, number]} pixel
 * @returns {[number, number, number] | null}
 */
export function valueAt(frame, resolution, pixel) {
  const x = Math.floor(((pixel[0] + 0.5) * frame.resolution[0]) / resolution[0]) - frame.origin[0];
  const y = Math.floor(((pixel[1] + 0.5) * frame.resolution[1]) / resolution[1]) - frame.origin[1];
  if (x < 0 || y < 0 || x >= frame.size[0] || y >= frame.size[1]) return null;
  const at = 3 * (y * frame.size[0] + x);
  return [frame.channels[at], frame.channels[at + 1], frame.channels[at + 2]];
}

/**
 * Bytes of a base64 text.
 * @param {string} text
 */
export function bytesOf(text) {
  return Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
}

/**
 * The number of a half float.
 * @param {number} bits
 */
export function fromHalf(bits) {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const mantissa = bits & 1023;
  if (exponent === 0) return sign * mantissa * 2 ** -24;
  if (exponent === 31) return mantissa ? NaN : sign * Infinity;
  return sign * (1024 + mantissa) * 2 ** (exponent - 25);
}

/**
 * Half floats, low byte first in base64, as floats.
 * @param {string} text
 */
export function halves(text) {
  const bytes = bytesOf(text);
  return Float32Array.from({ length: bytes.length / 2 }, (_, i) => fromHalf(bytes[2 * i] | (bytes[2 * i + 1] << 8)));
}
