// Numbers of the report, and where plots put them.

import assert from "node:assert/strict";
import test from "node:test";
import { fraction, hasPlace, ruler } from "../../../lab/page/axis.js";
import { interval, number } from "../../../lab/page/number.js";

/** @import { Scale } from "../../../lab/page/results.js" */

test("numbers have four digits", () => {
  const cases = /** @type {[number | null, string][]} */ ([
    [0, "0"], [-0, "0"], [0.5, "0.5"], [1 / 3, "0.3333"], [-12.3456, "−12.35"], [9.99996, "10"],
    [123456, "123\u202f456"], [1234, "1234"], [54321.6, "54\u202f322"], [0.000123456, "0.0001235"],
    [0.0000123456, "1.235·10⁻⁵"], [9.9999e-5, "1·10⁻⁴"], [2.5e9, "2.5·10⁹"], [NaN, "no number"],
    [null, "no number"], [-Infinity, "−∞"], [1e6, "1\u202f000\u202f000"],
  ]);
  for (const [value, expected] of cases) assert.equal(number(value), expected);
});

test("an interval decides the digits", () => {
  const cases = /** @type {[[number, number, number | null], string][]} */ ([
    [[0.853, 0.821, 0.884], "0.85 [0.82, 0.88]"],
    [[0.85, 0.84, 0.86], "0.850 [0.840, 0.860]"],
    [[12, -3, 27], "12 [−3, 27]"],
    [[1, 1, 1], "1 [1, 1]"],
    [[2.13e-6, 1.91e-6, 2.35e-6], "2.13 [1.91, 2.35] ·10⁻⁶"],
    [[123456, 110000, 140000], "123\u202f456 [110\u202f000, 140\u202f000]"],
    [[1, 0.5, Infinity], "1 [0.5, ∞]"],
    [[1, 0.5, null], "1 [0.5, no number]"],
  ]);
  for (const [[value, low, high], expected] of cases) assert.equal(interval(value, low, high), expected);
});

/** @param {Scale} scale @param {number[]} values */
const labels = (scale, values) => ruler(scale, values)?.ticks.map(({ label }) => label).join(" ");

test("linear ticks are 1, 2 and 5", () => {
  const cases = /** @type {[number[], string][]} */ ([
    [[0, 1], "0.0 0.2 0.4 0.6 0.8 1.0"],
    [[0, 100], "0 20 40 60 80 100"],
    [[-3, 7], "−2 0 2 4 6"],
    [[5, 5], "4.6 4.8 5.0 5.2 5.4"],
    [[0, 0.0031], "0.000 0.001 0.002 0.003"],
    [[0, 3e9], "0 1·10⁹ 2·10⁹ 3·10⁹"],
  ]);
  for (const [values, expected] of cases) assert.equal(labels("linear", values), expected);
});

test("logarithmic ticks are powers and their 2 and 5", () => {
  const cases = /** @type {[number[], string][]} */ ([
    [[1, 1e5], "1 10 10² 10³ 10⁴ 10⁵"],
    [[1e-6, 1e-2], "10⁻⁶ 10⁻⁵ 10⁻⁴ 10⁻³ 10⁻²"],
    [[3, 90], "5 10 20 50 100"],
    [[0.4, 0.9], "0.4 0.6 0.8 1.0"],
    [[1e-20, 1e12], "10⁻²⁰ 10⁻¹⁵ 10⁻¹⁰ 10⁻⁵ 1 10⁵ 10¹⁰"],
  ]);
  for (const [values, expected] of cases) assert.equal(labels("log", values), expected);
});

test("all values have a place inside", () => {
  for (const scale of /** @type {Scale[]} */ (["linear", "log"])) {
    const values = [0.013, 1, 77];
    const made = ruler(scale, [...values, NaN, Infinity, null]);
    assert.ok(made);
    for (const value of values) assert.ok(fraction(made, value) > 0 && fraction(made, value) < 1, `${scale} ${value}`);
    for (const { value, label } of made.ticks) assert.ok(fraction(made, value) >= 0 && fraction(made, value) <= 1, label);
  }
});

test("what has no logarithm has no place", () => {
  assert.equal(ruler("log", [0, -1, null]), null);
  const made = ruler("log", [0, 1, 10]);
  assert.ok(made && !hasPlace("log", 0) && fraction(made, 0) === 0);
});
