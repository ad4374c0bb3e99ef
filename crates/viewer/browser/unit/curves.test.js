// Where curves of errors are drawn.

import assert from "node:assert/strict";
import test from "node:test";
import { FRAME, axis, line, plot, ticks, usable } from "../../page/curves.js";

/** @import { Point } from "../../page/curves.js" */

test("marks are round numbers within the axis", () => {
  assert.deepEqual(ticks(1, 10), [1, 2, 5, 10]);
  assert.deepEqual(ticks(0.03, 0.9), [0.05, 0.1, 0.2, 0.5]);
  assert.deepEqual(ticks(0.01, 1000), [0.01, 0.1, 1, 10, 100, 1000]);
  assert.ok(ticks(1e-12, 1e12).length <= 7);
});

test("an axis has all of its values and at least two marks", () => {
  for (const values of [[3], [3, 3.1], [0.4, 900], [1e-5, 2e-5], [6, 9]]) {
    const { low, high, marks } = axis(values);
    assert.ok(values.every((value) => value >= low && value <= high), String(values));
    assert.ok(marks.length >= 2, `${values}: ${marks}`);
    assert.ok(marks.every((mark) => mark >= low * 0.999 && mark <= high * 1.001), `${values}: ${marks}`);
  }
});

test("what has no logarithm is left out", () => {
  const curve = /** @type {Point[]} */ ([[0, 1], [1, 0], [1, NaN], [1, Infinity], [-1, 2], [2, 0.5]]);
  assert.deepEqual(usable(curve), [[2, 0.5]]);
  assert.equal(plot([[], curve.slice(0, 5)]), null);
});

test("a power law is a straight line within the frame", () => {
  const curve = /** @type {Point[]} */ ([1, 4, 16, 64].map((x) => [x, 1 / Math.sqrt(x)]));
  const made = plot([curve]);
  assert.ok(made);
  const places = curve.map((point) => made.place(point));
  for (const [x, y] of places) {
    assert.ok(x >= FRAME.left && x <= FRAME.width - FRAME.right && y >= FRAME.top && y <= FRAME.height - FRAME.bottom);
  }
  const slopes = [0, 1, 2].map((i) => (places[i + 1][1] - places[i][1]) / (places[i + 1][0] - places[i][0]));
  assert.ok(slopes[0] > 0, "errors that fall go down");
  assert.ok(slopes.every((slope) => Math.abs(slope - slopes[0]) < 1e-9), String(slopes));
  assert.equal(line(made, curve).split(" ").length, 4);
});

test("curves share their axes", () => {
  const made = plot([[[1, 0.1]], [[100, 0.9]]]);
  assert.ok(made);
  assert.equal(made.place([1, 0.1])[0], FRAME.left);
  assert.equal(made.place([100, 0.9])[0], FRAME.width - FRAME.right);
  assert.equal(made.place([100, 0.9])[1], FRAME.top);
});
