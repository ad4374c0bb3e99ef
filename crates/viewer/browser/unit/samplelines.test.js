// The drawing of a sample.

import assert from "node:assert/strict";
import test from "node:test";
import { fate, names, opacity, pieces, rays, width } from "../../page/samplelines.js";

/** @import { SampleCandidate, SampleReport, SampleVertex } from "../../page/types.js" */
/** @import { Point } from "../../../lab/page/view.js" */

/**
 * @param {Point | null} raster
 * @returns {SampleVertex}
 */
function vertex(raster) {
  return { kind: "surface", position: [0, 0, 0], is_infinite: false, is_delta: false, beta: [1, 1, 1], raster };
}

/**
 * @param {number} s
 * @param {number} t
 * @param {number} value
 * @param {Partial<SampleCandidate>} other
 * @returns {SampleCandidate}
 */
function candidate(s, t, value, other = {}) {
  const light = { position: /** @type {[number, number, number]} */ ([0, 0, 0]), is_infinite: false, raster: /** @type {Point} */ ([9, 9]) };
  const zero = /** @type {[number, number, number]} */ ([0, 0, 0]);
  const grey = /** @type {[number, number, number]} */ ([value, value, value]);
  return { s, t, contribution: grey, weight: 1, value: grey, added: zero, light_end: light, score: value, prob: 1, is_chosen: true, is_visible: true, ...other };
}

/**
 * @param {SampleCandidate[]} candidates
 * @returns {SampleReport}
 */
function report(candidates) {
  const camera = { vertices: [vertex(null), vertex([1, 2]), vertex([3, 4]), vertex(null)], escape: null };
  const light = { vertices: [vertex([9, 9])], escape: null };
  return { generation: 1, pixel: [1, 2], pass: 0, camera, light, hits: [], candidates, zeros: [], light_image: [], value: [0, 0, 0], value_of_all_candidates: [0, 0, 0], rays: 1 };
}

test("a candidate's fate is the selection's and the shadow ray's", () => {
  assert.equal(fate({ is_chosen: true, is_visible: true }), "chosen");
  assert.equal(fate({ is_chosen: true, is_visible: false }), "blocked");
  assert.equal(fate({ is_chosen: false, is_visible: false }), "left");
});

test("rays go from the light's end to vertex t - 1", () => {
  const [first, second] = rays(report([candidate(1, 2, 1), candidate(2, 3, 0.1, { prob: 0.5, is_visible: false })]));
  assert.deepEqual([first.from, first.to, first.fate, first.opacity], [[9, 9], [1, 2], "chosen", 1]);
  assert.deepEqual([second.to, second.fate, second.name], [[3, 4], "blocked", "candidate-1"]);
  assert.ok(second.opacity < 1 && second.opacity > 0.3);
  assert.ok(second.width < first.width);
});

test("rays without a place on the film are left out, and keep the numbers of others", () => {
  const behind = { light_end: { position: /** @type {[number, number, number]} */ ([0, 0, 0]), is_infinite: false, raster: null } };
  const drawn = rays(report([candidate(1, 4, 1), candidate(1, 2, 1, behind), candidate(1, 3, 1)]));
  assert.deepEqual(drawn.map((ray) => ray.name), ["candidate-2"]);
});

test("widths and opacities stay within what can be seen", () => {
  assert.equal(width(candidate(1, 2, 0), 0), width(candidate(1, 2, 0), 5));
  assert.ok(width(candidate(1, 2, 5), 5) > 3 * width(candidate(1, 2, 0), 5));
  for (const prob of [0, 1e-9, 0.5, 1, 2]) assert.ok(opacity(prob) >= 0.35 && opacity(prob) <= 1, String(prob));
});

test("a subpath is interrupted behind the camera", () => {
  const subpath = { vertices: [null, [1, 2], [3, 4], null, [5, 6]].map((at) => vertex(/** @type {Point | null} */ (at))), escape: null };
  assert.deepEqual(pieces(subpath), [[[1, 2], [3, 4]], [[5, 6]]]);
  assert.deepEqual(names(subpath, "z").map(({ name }) => name), ["z₁", "z₂", "z₄"]);
});
