// Tables, plots and words of the report, as far as they need no page.

import assert from "node:assert/strict";
import test from "node:test";
import { share } from "../../../lab/page/images.js";
import { LARGE, frameOf, leftOut, place } from "../../../lab/page/plot.js";
import { counts, ranges } from "../../../lab/page/sections.js";
import { ranks } from "../../../lab/page/table.js";

/** @import { Cell, Claim, Plot } from "../../../lab/page/results.js" */

const interval = (/** @type {number} */ value, /** @type {number} */ half) => ({ value, low: value - half, high: value + half });

/** @param {string} head @param {[string, Cell][]} rows */
const ranked = (head, rows) =>
  ranks({ caption: "", columns: ["scene", "method", head], rows: rows.map(([scene, cell], i) => [scene, `m${i}`, cell]) }, 2);

test("the best of each scene is marked, with all that cannot be told from it", () => {
  /** @type {[string, Cell][]} */
  const rows = [
    ["a", interval(1, 0.1)],
    ["a", interval(1.15, 0.1)],
    ["a", interval(1.3, 0.04)],
    ["b", interval(7, 0.1)],
    ["b", null],
    ["b", interval(6, 0.1)],
  ];
  assert.deepEqual(ranked("relmse", rows), ["best", "as-good", "none", "none", "none", "best"]);
  assert.deepEqual(ranked("gain ↑", rows), ["none", "none", "best", "best", "none", "none"]);
  assert.deepEqual(ranked("rays", rows), rows.map(() => "none"));
  assert.deepEqual(ranked("relmse", rows.slice(0, 1)), ["none"]);
  assert.deepEqual(ranked("efficiency_rays", [["a", 2], ["a", 3]]), ["none", "best"]);
});

/** @type {Plot} */
const PLOT = {
  caption: "",
  kind: "lines",
  x: { label: "rays", scale: "log" },
  y: { label: "error", scale: "log" },
  series: [{ name: "a", points: [[1, 2], [10, 0.2], [2, 0], [null, 1]], intervals: [] }],
};

test("points without a place are counted, and empty bins are not", () => {
  const frame = frameOf(PLOT, LARGE);
  assert.ok(frame);
  assert.equal(leftOut(PLOT, frame), 2);
  assert.equal(leftOut({ ...PLOT, kind: "histogram" }, frame), 1);
  assert.equal(frameOf({ ...PLOT, series: [{ name: "", points: [[0, 1]], intervals: [] }] }, LARGE), null);
});

test("a power law is a straight line within the frame", () => {
  const points = /** @type {[number, number][]} */ ([1, 4, 16, 64].map((x) => [x, 1 / Math.sqrt(x)]));
  const frame = frameOf({ ...PLOT, series: [{ name: "a", points, intervals: [] }] }, LARGE);
  assert.ok(frame);
  const places = points.map((point) => place(frame, point));
  for (const [x, y] of places) assert.ok(x > frame.left && x < frame.right && y > frame.top && y < frame.bottom);
  const slopes = [0, 1, 2].map((i) => (places[i + 1][1] - places[i][1]) / (places[i + 1][0] - places[i][0]));
  assert.ok(slopes[0] > 0, "errors that fall go down");
  assert.ok(slopes.every((slope) => Math.abs(slope - slopes[0]) < 1e-9), String(slopes));
});

test("neighbouring seeds are ranges, however large", () => {
  assert.equal(ranges([]), "");
  assert.equal(ranges([3, 1, 2, 9, 11, 12, 2]), "1–3, 9, 11–12");
  assert.equal(ranges(["18446744073709551614", "18446744073709551615"]), "18446744073709551614–18446744073709551615");
});

test("verdicts are counted", () => {
  const claims = ["not-met", "reproduced", "reproduced"].map((verdict) => /** @type {Claim} */ (/** @type {unknown} */ ({ verdict })));
  assert.equal(counts(claims), "3 claims: 2 reproduced, 1 not met.");
  assert.equal(counts(claims.slice(0, 1)), "1 claim: 1 not met.");
});

test("errors have colours by their logarithm, FLIP by itself", () => {
  assert.deepEqual([share("relative", 0), share("relative", 1e-4), share("relative", 10)], [0, 0, 1]);
  assert.ok(Math.abs(share("relative", 10 ** -1.5) - 0.5) < 1e-12);
  assert.equal(share("flip", 0.3), 0.3);
  assert.ok(Number.isNaN(share("relative", NaN)));
});
