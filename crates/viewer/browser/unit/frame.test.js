// Frames are read as the server writes them, and nothing else is.

import assert from "node:assert/strict";
import test from "node:test";
import { fromHalf, halves, valueAt } from "../../../lab/page/pixels.js";
import { decodeFrame } from "../../page/frame.js";

/**
 * The bytes of a frame.
 * @param {number[]} header
 * @param {number[]} channels
 */
function bytes(header, channels) {
  const buffer = Buffer.alloc(40 + 4 * channels.length);
  buffer.write("BDF1", "latin1");
  header.forEach((value, i) => buffer.writeUInt32LE(value, 4 + 4 * i));
  channels.forEach((value, i) => buffer.writeFloatLE(value, 40 + 4 * i));
  return buffer.buffer.slice(buffer.byteOffset, buffer.byteOffset + buffer.length);
}

const HEADER = [1, 7, 12, 40, 30, 3, 4, 2, 1];
const CHANNELS = [0.25, 0.5, 1, 2, 4, 8];

test("a frame has its header's numbers and its floats", () => {
  const frame = decodeFrame(bytes(HEADER, CHANNELS));
  assert.equal(frame.lane, "b");
  assert.equal(frame.generation, 7);
  assert.equal(frame.passes, 12);
  assert.deepEqual(frame.resolution, [40, 30]);
  assert.deepEqual(frame.origin, [3, 4]);
  assert.deepEqual(frame.size, [2, 1]);
  assert.deepEqual([...frame.channels], CHANNELS);
});

test("what is no frame is refused", () => {
  assert.throws(() => decodeFrame(new ArrayBuffer(39)), /has no header/);
  assert.throws(() => decodeFrame(new ArrayBuffer(64)), /BDF1/);
  assert.throws(() => decodeFrame(bytes(HEADER, CHANNELS.slice(1))), /2 x 1 pixels has 60 bytes, not 64/);
  assert.throws(() => decodeFrame(bytes(HEADER, [...CHANNELS, 1])), /not 64/);
});

test("a pixel's value is found where the crop has it", () => {
  const frame = decodeFrame(bytes(HEADER, CHANNELS));
  assert.deepEqual(valueAt(frame, [40, 30], [3, 4]), [0.25, 0.5, 1]);
  assert.deepEqual(valueAt(frame, [40, 30], [4, 4]), [2, 4, 8]);
  for (const outside of /** @type {[number, number][]} */ ([[2, 4], [5, 4], [3, 3], [3, 5]])) {
    assert.equal(valueAt(frame, [40, 30], outside), null, String(outside));
  }
});

test("a preview's pixel stands for all that it covers", () => {
  const frame = decodeFrame(bytes(HEADER, CHANNELS));
  // The film has four times as many pixels along each side.
  assert.deepEqual(valueAt(frame, [160, 120], [12, 16]), [0.25, 0.5, 1]);
  assert.deepEqual(valueAt(frame, [160, 120], [15, 19]), [0.25, 0.5, 1]);
  assert.deepEqual(valueAt(frame, [160, 120], [16, 16]), [2, 4, 8]);
});

test("half floats are those of IEEE 754", () => {
  const known = [[0x0000, 0], [0x3c00, 1], [0xc000, -2], [0x3555, 0.333251953125], [0x7bff, 65504], [0x0400, 2 ** -14], [0x0001, 2 ** -24], [0xfc00, -Infinity]];
  for (const [bits, value] of known) assert.equal(fromHalf(bits), value);
  assert.ok(Object.is(fromHalf(0x8000), -0) && Number.isNaN(fromHalf(0x7e00)));
  // 1.0, 0.5, 0.0 twice: 00 3c 00 38 00 00.
  assert.deepEqual([...halves("ADwAOAAAADwAOAAA")], [1, 0.5, 0, 1, 0.5, 0]);
});
