// The strategies: the pyramid of their images, weighted and raw, and their numbers.

import { make } from "./dom.js";
import { cell } from "./format.js";
import { number } from "./number.js";
import { halves } from "./pixels.js";
import { note, paragraph, section } from "./sections.js";
import { NOTHING, tableOf } from "./table.js";
import { canvasOf, meaning, rowName, rowOf, rowsOf, stopsOf } from "./tiles.js";

/** @import { Cell, Layers, PyramidInfo, Report, Strategy, Table } from "./results.js" */

/** A tile: its name, its meaning, the mean luminance, and its layer. @typedef {{name: string, title: string, mean: number, layer: string}} Tile */

const KINDS = [
  { word: "Weighted", meaning: "the contribution of each strategy to the image", prefix: "", mean: (/** @type {Strategy} */ of) => of.mean },
  { word: "Raw", meaning: "each strategy alone, without its weight", prefix: "raw.", mean: (/** @type {Strategy} */ of) => of.raw_mean },
];

/**
 * For each scene its pyramid and a table.
 * @param {Report} report
 */
export function strategies({ results, layers }) {
  const pyramids = results.pyramids ?? [];
  if (pyramids.length === 0) {
    return section("strategies", "Strategies", [
      paragraph('None are shown. In a description, pyramid = "METHOD" shows those of a method.'),
    ]);
  }
  const sizes = new Map(results.scenes.map(({ name, size }) => [name, String(size)]));
  return section("strategies", "Strategies", [
    paragraph(
      "A path of s + t vertices can be made by s from the light and t from the camera. Weighted images show the contribution of each strategy (s, t) to the image, raw ones the strategy alone: all images of a row estimate the same light, and where one is noisy its weight should be small. ×8, /8: shown 8 times as bright or as dark as it is, all of a row alike; means are of the light as it is.",
    ),
    ...pyramids.map((pyramid, i) => article(pyramid, layers[i] ?? {}, sizes.get(pyramid.scene) === String(pyramid.size))),
  ]);
}

/**
 * The strategies of a scene.
 * @param {PyramidInfo} pyramid
 * @param {Layers} layers
 * @param {boolean} isWhole
 */
function article(pyramid, layers, isWhole) {
  const { scene, method, seed, spp, size, vertices } = pyramid;
  const smaller = isWhole ? "" : ", smaller than the renders";
  const absent = absentOf(pyramid);
  const about = `${number(spp)} samples per pixel, seed ${seed}, ${size.join(" × ")} pixels${smaller}; paths of up to ${vertices} vertices. No time or ray of it counts elsewhere in this page.`;
  const missing = `Nothing was counted for ${absent.join(", ")}: the method leaves them out, or they make no path of this scene.`;
  return make("article", { class: "strategies" }, [
    make("h3", {}, [`${scene}: ${method}`]),
    paragraph(about),
    ...KINDS.map((kind) => pyramidOf(pyramid, layers, kind)),
    tableOf(numbers(pyramid)),
    ...(absent.length > 0 ? [note(missing)] : []),
  ]);
}

/**
 * @param {PyramidInfo} pyramid
 * @param {Layers} layers
 * @param {typeof KINDS[number]} kind
 */
function pyramidOf(pyramid, layers, { word, meaning: words, prefix, mean }) {
  const whole = [
    { name: "the picture", title: "all paths", mean: pyramid.mean, layer: "" },
    { name: "longer paths", title: "paths of more vertices", mean: pyramid.longer, layer: "longer" },
  ];
  const tile = (/** @type {Strategy} */ of) => ({ name: name(of), title: meaning(of), mean: mean(of), layer: `${prefix}s${of.s}t${of.t}` });
  const rows = rowsOf(pyramid.strategies).flatMap(([vertices, row]) => tileRow(rowName(vertices), row.map(tile), pyramid, layers));
  return make("details", { open: "" }, [
    make("summary", {}, [`${word}: ${words}`]),
    make("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": `${word} images of ${pyramid.scene}` }, [
      ...tileRow("all paths", whole, pyramid, layers),
      ...rows,
    ]),
  ]);
}

/**
 * @param {string} title
 * @param {Tile[]} tiles
 * @param {PyramidInfo} pyramid
 * @param {Layers} layers
 */
function tileRow(title, tiles, { size }, layers) {
  const images = tiles.flatMap((tile) => (layers[tile.layer] === undefined ? [] : [{ tile, channels: halves(layers[tile.layer]) }]));
  const stops = stopsOf(images.map(({ channels }) => channels));
  const exposure = stops === 0 ? "" : `, shown ${stops > 0 ? "×" : "/"}${2 ** Math.abs(stops)}`;
  const faces = images.map(({ tile, channels }) => {
    const canvas = canvasOf(channels, size, stops);
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${tile.name}: ${tile.title}, mean ${cell(tile.mean)}`);
    return make("figure", { class: "tile", title: tile.title }, [
      canvas,
      make("figcaption", {}, [make("b", {}, [tile.name]), tile.mean === 0 ? " no light" : ` mean ${cell(tile.mean)}`]),
    ]);
  });
  return rowOf(`${title}${exposure}`, faces);
}

/** @param {{s: number, t: number}} strategy */
function name({ s, t }) {
  return `s=${s} t=${t}`;
}

/**
 * @param {PyramidInfo} pyramid
 * @returns {Table}
 */
function numbers(pyramid) {
  const samples = pyramid.spp * pyramid.size[0] * pyramid.size[1];
  const share = (/** @type {number} */ mean) => (100 * mean) / pyramid.mean;
  const rows = pyramid.strategies.map((of) => {
    const known = (/** @type {number} */ value) => (of.rays > 0 ? value : NOTHING);
    return [name(of), of.mean, share(of.mean), of.raw_mean, of.variance ?? NOTHING, known(of.rays / samples), known((100 * of.blocked) / of.rays)];
  });
  const rest = [["longer paths", pyramid.longer], ["the picture", pyramid.mean]].map(([words, mean]) => [
    words, mean, share(Number(mean)), NOTHING, NOTHING, NOTHING, NOTHING,
  ]);
  return {
    caption:
      "Luminances are means over the image. Variance: of what one sample per pixel adds to a pixel of the weighted image, in the mean pixel.",
    columns: ["strategy", "mean", "% of the image", "raw mean", "variance", "rays / sample", "blocked %"],
    rows: /** @type {Cell[][]} */ ([...rows, ...rest]),
  };
}

/**
 * The strategies that are not in the table.
 * @param {PyramidInfo} pyramid
 */
export function absentOf({ vertices, strategies }) {
  const known = new Set(strategies.map(name));
  const names = Array.from({ length: Math.max(0, vertices - 1) }, (_, i) => i + 2).flatMap((n) =>
    Array.from({ length: n }, (_, s) => name({ s, t: n - s })),
  );
  return names.filter((one) => !known.has(one));
}
