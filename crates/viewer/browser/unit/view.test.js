// The place of the film on the screen.

import assert from "node:assert/strict";
import test from "node:test";
import { ZOOM_RANGE, centred, fit, pan, pixelAt, toFilm, toScreen, zoomAt } from "../../../lab/page/view.js";

/** @import { Point, View } from "../../../lab/page/view.js" */

/** @type {View} */
const VIEW = { zoom: 2.5, offset: [13, -7] };

/**
 * @param {readonly number[]} a
 * @param {readonly number[]} b
 */
function near(a, b) {
  a.forEach((value, i) => assert.ok(Math.abs(value - b[i]) < 1e-9, `${a} is not ${b}`));
}

test("film to screen and back", () => {
  for (const point of /** @type {Point[]} */ ([[0, 0], [17.5, -3], [400, 300]])) {
    near(toFilm(VIEW, toScreen(VIEW, point)), point);
  }
  near(toScreen(VIEW, [2, 2]), [18, -2]);
});

test("zooming keeps the point under the hand", () => {
  const hand = /** @type {Point} */ ([120, 45]);
  const before = toFilm(VIEW, hand);
  const view = zoomAt(VIEW, 3, hand);
  assert.equal(view.zoom, 7.5);
  near(toFilm(view, hand), before);
});

test("zoom has ends, where it still keeps the point", () => {
  const hand = /** @type {Point} */ ([120, 45]);
  for (const [factor, end] of [[1e9, ZOOM_RANGE[1]], [1e-9, ZOOM_RANGE[0]]]) {
    const view = zoomAt(VIEW, factor, hand);
    assert.equal(view.zoom, end);
    near(toFilm(view, hand), toFilm(VIEW, hand));
  }
});

test("fitting shows all of the film, in the middle", () => {
  for (const stage of /** @type {Point[]} */ ([[900, 600], [390, 300], [200, 900]])) {
    const film = /** @type {Point} */ ([400, 300]);
    const view = fit(film, stage);
    const [left, top] = toScreen(view, [0, 0]);
    const [right, bottom] = toScreen(view, film);
    near([left, top], [stage[0] - right, stage[1] - bottom]);
    assert.ok(left >= 0 && top >= 0, `${left} ${top}`);
    assert.ok(Math.min(left, top) <= 16 + 1e-9, `${left} ${top}: room is left`);
  }
  near(centred([400, 300], [500, 500], 1).offset, [50, 100]);
});

test("panning moves by what it is told, and never out of sight", () => {
  const [film, stage] = /** @type {[Point, Point]} */ ([[100, 100], [500, 400]]);
  near(pan(VIEW, [10, 20], film, stage).offset, [23, 13]);
  near(pan(VIEW, [1e6, 1e6], film, stage).offset, [468, 368]);
  near(pan(VIEW, [-1e6, -1e6], film, stage).offset, [32 - 250, 32 - 250]);
});

test("pixels are those of the crop", () => {
  const crop = /** @type {[number, number, number, number]} */ ([2, 3, 10, 8]);
  assert.deepEqual(pixelAt(VIEW, toScreen(VIEW, [2.1, 3.9]), crop), [2, 3]);
  assert.deepEqual(pixelAt(VIEW, toScreen(VIEW, [9.9, 7.9]), crop), [9, 7]);
  assert.equal(pixelAt(VIEW, toScreen(VIEW, [1.9, 5]), crop), null);
  assert.equal(pixelAt(VIEW, toScreen(VIEW, [10.1, 5]), crop), null);
});
