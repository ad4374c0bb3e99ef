// Frames as they come by the socket: a header of ten numbers of 32 bits, then linear Rec. 709 in
// floats, row by row from the top left; all little endian.

/** @import { LaneName } from "./types.js" */

/**
 * @typedef {object} Frame
 * @property {LaneName} lane
 * @property {number} generation
 * @property {number} passes
 * @property {[number, number]} resolution Of the film that the frame is a part of.
 * @property {[number, number]} origin Of the crop on that film.
 * @property {[number, number]} size Of the crop.
 * @property {Float32Array} channels Three for each pixel of the crop.
 */

const MAGIC = 0x31464442; // "BDF1"
const HEADER = 40;

/**
 * Reads a frame.
 * @param {ArrayBuffer} bytes
 * @returns {Frame}
 */
export function decodeFrame(bytes) {
  if (bytes.byteLength < HEADER) throw new RangeError(`a frame of ${bytes.byteLength} bytes has no header`);
  const view = new DataView(bytes);
  if (view.getUint32(0, true) !== MAGIC) throw new RangeError("a frame does not begin with BDF1");
  const [lane, generation, passes, width, height, x, y, w, h] = Array.from({ length: 9 }, (_, i) =>
    view.getUint32(4 + 4 * i, true),
  );
  const expected = HEADER + 12 * w * h;
  if (bytes.byteLength !== expected) {
    throw new RangeError(`a frame of ${w} x ${h} pixels has ${bytes.byteLength} bytes, not ${expected}`);
  }
  return {
    lane: lane === 0 ? "a" : "b",
    generation,
    passes,
    resolution: [width, height],
    origin: [x, y],
    size: [w, h],
    channels: floats(bytes, view),
  };
}

/**
 * The floats behind the header, without a copy where the machine has the order of the bytes.
 * @param {ArrayBuffer} bytes
 * @param {DataView} view
 */
function floats(bytes, view) {
  const isLittle = new Uint8Array(Uint32Array.of(1).buffer)[0] === 1;
  if (isLittle) return new Float32Array(bytes, HEADER);
  const count = (bytes.byteLength - HEADER) / 4;
  return Float32Array.from({ length: count }, (_, i) => view.getFloat32(HEADER + 4 * i, true));
}

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
