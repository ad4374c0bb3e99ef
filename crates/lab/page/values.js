// The numbers of pixels, written into them where they are large enough; and the chosen pixel's frame.

import { draw, get } from "./dom.js";
import { cell } from "./format.js";
import { valueAt } from "./pixels.js";
import { VALUES_ZOOM, toFilm, toScreen } from "./view.js";

/** @import { Stage } from "./stage.js" */
/** @import { Point } from "./view.js" */

const COLORS = ["#ff8a8a", "#8be78b", "#8fb8ff"];

/**
 * Writes the values of all pixels in sight, if they are large enough.
 * @param {Stage} stage
 */
export function drawValues(stage) {
  const canvas = get("values", HTMLCanvasElement);
  const context = canvas.getContext("2d");
  if (!context) return;
  const density = window.devicePixelRatio || 1;
  context.setTransform(density, 0, 0, density, 0, 0);
  context.clearRect(0, 0, canvas.width, canvas.height);
  if (stage.view.zoom < VALUES_ZOOM) return;
  context.font = `${Math.min(stage.view.zoom / 5.2, 15)}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineWidth = 3;
  context.strokeStyle = "#000c";
  for (const pixel of pixelsInSight(stage)) writeValue(context, stage, pixel);
}

/**
 * @param {Stage} stage
 * @returns {Point[]}
 */
function pixelsInSight({ view, size, crop }) {
  const low = toFilm(view, [0, 0]);
  const high = toFilm(view, size);
  const [x0, y0] = [0, 1].map((axis) => Math.max(crop[axis], Math.floor(low[axis])));
  const [x1, y1] = [0, 1].map((axis) => Math.min(crop[axis + 2], Math.ceil(high[axis])));
  /** @type {Point[]} */
  const pixels = [];
  for (let y = y0; y < y1; y++) {
    for (let x = x0; x < x1; x++) pixels.push([x, y]);
  }
  return pixels;
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Stage} stage
 * @param {Point} pixel
 */
function writeValue(context, stage, pixel) {
  const [x, y] = toScreen(stage.view, [pixel[0] + 0.5, pixel[1] + 0.5]);
  const isOfB = stage.picture?.frame("b") && x >= stage.divide * stage.size[0];
  const frame = stage.picture?.frame(isOfB ? "b" : "a");
  const value = frame && valueAt(frame, stage.film, pixel);
  if (!value) return;
  const step = Math.min(stage.view.zoom / 4, 20);
  value.forEach((channel, i) => {
    context.fillStyle = COLORS[i];
    context.strokeText(cell(channel), x, y + step * (i - 1));
    context.fillText(cell(channel), x, y + step * (i - 1));
  });
}

/**
 * The frame around the chosen pixel, and around it a ring where it is too small to be seen.
 * @param {Stage} stage
 * @returns {SVGElement[]}
 */
export function marker(stage) {
  if (!stage.pixel) return [];
  const [x, y] = toScreen(stage.view, stage.pixel);
  const side = stage.view.zoom;
  const parts = ["marker under", "marker"].map((name) =>
    draw("rect", { class: name, x: x - 1, y: y - 1, width: side + 2, height: side + 2 }),
  );
  if (side >= 6) return parts;
  const middle = { cx: x + side / 2, cy: y + side / 2, r: 8 };
  return ["marker under", "marker"].map((name) => draw("circle", { class: name, ...middle }));
}
