// Frames as they come by the socket: a header of ten numbers of 32 bits, then linear Rec. 709 in
// floats, row by row from the top left; all little endian.

/** @import { Frame as Pixels } from "./pixels.js" */

/** @typedef {Pixels & {generation: number, passes: number}} Frame */

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
