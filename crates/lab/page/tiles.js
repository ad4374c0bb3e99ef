// The pyramid of strategies: a tile for each (s, t), in a row for each number of vertices [Veach97, fig. 10.2].

import { make } from "./dom.js";
import { cell, compact, count, luminance, percent } from "./format.js";

/**
 * The text of a tile.
 * @typedef {object} StrategyTile
 * @property {number} s
 * @property {number} t
 * @property {number} mean
 * @property {number} traced
 * @property {number | null} blockedShare
 * @property {number | null} variance
 */

/**
 * Tiles by the number of vertices of their paths, s growing.
 * @template {{s: number, t: number}} T
 * @param {T[]} tiles
 * @returns {[number, T[]][]}
 */
export function rowsOf(tiles) {
  /** @type {Map<number, T[]>} */
  const rows = new Map();
  for (const tile of tiles) {
    const vertices = tile.s + tile.t;
    rows.set(vertices, [...(rows.get(vertices) ?? []), tile]);
  }
  const sorted = [...rows].sort(([a], [b]) => a - b);
  return sorted.map(([vertices, row]) => [vertices, row.sort((a, b) => a.s - b.s)]);
}

/** @param {number} vertices */
export function rowName(vertices) {
  return `${vertices} vertices, ${count(vertices - 2, "bounce")}`;
}

/**
 * Describes a strategy in words.
 * @param {{s: number, t: number}} strategy
 */
export function meaning({ s, t }) {
  if (s === 0) return "the camera subpath hits a light";
  if (t === 1) return "the light subpath is seen by the lens";
  if (s === 1) return "a point of a light is connected (next event)";
  return "both subpaths are connected";
}

/**
 * The figures of a tile.
 * @param {StrategyTile} tile
 */
export function figuresOf(tile) {
  return [
    `mean ${cell(tile.mean)}`,
    `traced ${compact(tile.traced)}`,
    `blocked ${percent(tile.blockedShare)}`,
    `variance ${tile.variance === null ? "–" : cell(Number(tile.variance.toPrecision(2)))}`,
  ];
}

/**
 * A row of tiles below its name.
 * @param {string} name
 * @param {HTMLElement[]} tiles
 */
export function rowOf(name, tiles) {
  return [make("h4", {}, [name]), make("div", { class: "pyramid-row" }, tiles)];
}

/**
 * The stops by which images of a row are brightened, so that nine tenths of the lit pixels of the
 * brightest are below white. An image of few lit pixels, compared with others of its row, is noise: it
 * has no say.
 * @param {Float32Array[]} images
 */
export function stopsOf(images) {
  const lit = images.map((channels) => {
    const values = Array.from({ length: channels.length / 3 }, (_, i) => luminance(channels.slice(3 * i, 3 * i + 3)));
    return Float64Array.from(values.filter((value) => value > 0)).sort();
  });
  const most = Math.max(0, ...lit.map((values) => values.length));
  const bright = lit.filter((values) => 2 * values.length > most).map((values) => values[Math.floor((values.length * 9) / 10)]);
  const brightest = Math.max(0, ...bright);
  return brightest > 0 ? Math.min(Math.max(Math.floor(Math.log2(0.9 / brightest)), -30), 30) : 0;
}

/**
 * An image, so many stops brighter, as sRGB.
 * @param {Float32Array} channels
 * @param {[number, number]} size
 * @param {number} stops
 */
export function canvasOf(channels, [width, height], stops) {
  const canvas = make("canvas", { width: String(width), height: String(height) });
  const target = new ImageData(width, height);
  for (let i = 0; i < width * height; i++) {
    const color = channels.slice(3 * i, 3 * i + 3).map((light) => 255 * coded(light * 2 ** stops));
    target.data.set([...color, 255], 4 * i);
  }
  canvas.getContext("2d")?.putImageData(target, 0, 0);
  return canvas;
}

/** @param {number} light */
function coded(light) {
  const clipped = Math.min(Math.max(light, 0), 1);
  return clipped <= 0.0031308 ? 12.92 * clipped : 1.055 * clipped ** (1 / 2.4) - 0.055;
}
