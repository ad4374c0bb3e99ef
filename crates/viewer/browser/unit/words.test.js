// Numbers as people read them, addresses, and scales.

import assert from "node:assert/strict";
import test from "node:test";
import { MAGMA, STOPS, magma, marks } from "../../../lab/page/falsecolor.js";
import { cell, compact, count, digits, duration, exact, percent } from "../../../lab/page/format.js";
import { share } from "../../page/head.js";
import { address, backoff } from "../../page/link.js";

/** @import { Lane } from "../../page/types.js" */

test("large numbers are short", () => {
  const told = [0, 12.345, 950, 999.6, 12345, 4.56e6, 7e9, NaN].map(compact);
  assert.deepEqual(told, ["0", "12.3", "950", "1 k", "12.3 k", "4.56 M", "7 G", "–"]);
});

test("one is one", () => {
  assert.deepEqual([count(0, "pass"), count(1, "pass"), count(2, "bounce")], ["0 passes", "1 pass", "2 bounces"]);
});

test("times change their unit", () => {
  const told = [0, 4.24, 59.94, 59.96, 187, 3599, 7500, null].map(duration);
  assert.deepEqual(told, ["0.0 s", "4.2 s", "59.9 s", "1:00 min", "3:07 min", "59:59 min", "2:05 h", "–"]);
});

test("nine digits tell floats apart", () => {
  const floats = new Float32Array([0.1, 1 / 3, 16777215, 1e-20, 3.4e38]);
  for (const value of floats) assert.equal(Math.fround(Number(exact(value))), value);
  assert.notEqual(exact(Math.fround(1 / 3)), exact(Math.fround(1 / 3 + 2 ** -25)));
});

test("cells are at most eight characters", () => {
  for (const value of [0, 1, 0.123456, 1234.56, 12345, 1e-9, 3.4e38, 9999.9]) {
    assert.ok(cell(value).length <= 8, `${value}: ${cell(value)}`);
  }
  assert.equal(percent(0.12345), "12.3 %");
  assert.equal(percent(null), "–");
  assert.equal(digits(0.000123456, 3), "0.000123");
});

test("the token goes with every request", () => {
  assert.equal(address(null, "/log"), "/log");
  assert.equal(address("a b", "/pixel", { lane: "a", x: 3 }), "/pixel?lane=a&x=3&token=a+b");
});

test("tries become rarer, up to a limit", () => {
  const waits = Array.from({ length: 20 }, (_, tries) => backoff(tries));
  assert.equal(waits[0], 0.5);
  waits.slice(1).forEach((wait, i) => assert.ok(wait >= waits[i] && wait <= 15));
});

test("progress is that of the lane that has furthest to go", () => {
  const lane = (/** @type {number} */ passes, /** @type {number | null} */ target) =>
    /** @type {Lane} */ (/** @type {unknown} */ ({ passes, target }));
  assert.equal(share([lane(3, 12)]), 0.25);
  assert.equal(share([lane(6, 12), lane(1, 10)]), 0.1);
  assert.equal(share([lane(6, 12), lane(1, null)]), null);
  assert.equal(share([]), null);
});

test("false colour goes from dark to bright, and its marks follow the exposure", () => {
  const sums = [0, 0.25, 0.5, 0.75, 1].map((t) => (magma(t).match(/\d+/g) ?? []).reduce((sum, part) => sum + Number(part), 0));
  sums.slice(1).forEach((sum, i) => assert.ok(sum > sums[i], String(sums)));
  assert.equal(MAGMA.length, 3);
  assert.deepEqual(marks(0).at(-1), { t: 1, value: 2 ** STOPS[1] });
  assert.equal(marks(3)[0].value, marks(0)[0].value / 8);
});
