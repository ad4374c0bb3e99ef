// The pyramid of strategies.

import assert from "node:assert/strict";
import test from "node:test";
import { absentOf } from "../../../lab/page/strategies.js";
import { rowName, rowsOf, stopsOf } from "../../../lab/page/tiles.js";

/** @import { PyramidInfo } from "../../../lab/page/results.js" */

const tile = (/** @type {number} */ s, /** @type {number} */ t) => ({ s, t });

test("strategies are in rows by their vertices", () => {
  const rows = rowsOf([tile(2, 1), tile(0, 2), tile(1, 2), tile(1, 1), tile(0, 3)]);
  const places = rows.map(([count, tiles]) => [count, ...tiles.map(({ s, t }) => `${s},${t}`)]);
  assert.deepEqual(places, [[2, "0,2", "1,1"], [3, "0,3", "1,2", "2,1"]]);
  assert.equal(rowName(3), "3 vertices, 1 bounce");
});

test("rows are as bright as it takes, and noise has no say", () => {
  const image = (/** @type {number} */ value) => new Float32Array(12).fill(value);
  assert.equal(stopsOf([image(0.1), image(0.02)]), 3);
  assert.equal(stopsOf([image(4)]), -3);
  assert.equal(stopsOf([image(0)]), 0);
  const noisy = image(0);
  noisy.fill(9, 9);
  assert.equal(stopsOf([image(0.1), noisy, image(0)]), 3);
});

test("strategies without figures are named", () => {
  const pyramid = /** @type {PyramidInfo} */ (/** @type {unknown} */ ({ vertices: 3, strategies: [tile(0, 2), tile(1, 2)] }));
  assert.deepEqual(absentOf(pyramid), ["s=1 t=1", "s=0 t=3", "s=2 t=1"]);
});
