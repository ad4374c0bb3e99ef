// The parts of the report that are words, tables and plots.

import { make } from "./dom.js";
import { count } from "./format.js";
import { METRICS, words } from "./glossary.js";
import { number } from "./number.js";
import { LARGE, drawing, frameOf, leftOut } from "./plot.js";
import { NOTHING, tableOf } from "./table.js";

/** @import { Cell, Claim, Method, Plot, Report, Results, SceneInfo, Table, Verdict } from "./results.js" */

const LINKS = [
  ["verdicts", "Verdicts"],
  ["setting", "Comparison"],
  ["claims", "Claims"],
  ["more", "More"],
  ["strategies", "Strategies"],
  ["viewer", "Images"],
  ["again", "Again"],
  ["glossary", "Glossary"],
];

/** The class and text of each verdict, in the order in which they are counted. @type {Record<Verdict, [string, string]>} */
const VERDICTS = {
  reproduced: ["good", "✔ reproduced"],
  "not-reproduced": ["bad", "✘ not reproduced"],
  met: ["good", "✔ met"],
  "not-met": ["bad", "✘ not met"],
  undecided: ["open", "? undecided"],
  "not-measured": ["open", "– not measured"],
};

const AMOUNTS = {
  samples: "samples per pixel",
  rays: "rays of all kinds per pixel, with those of training",
  seconds: "seconds of rendering and training",
};

/**
 * A section with its heading.
 * @param {string} id
 * @param {string} heading
 * @param {(Node | string)[]} children
 */
export function section(id, heading, children) {
  return make("section", { id }, [make("h2", {}, [heading]), ...children]);
}

/** @param {...(Node | string)} children */
export function paragraph(...children) {
  return make("p", {}, children);
}

/** @param {string} text */
export function note(text) {
  return make("p", { class: "note" }, [text]);
}

/**
 * Words with their meanings.
 * @param {[string, string][]} pairs
 */
function definitions(pairs) {
  return make("dl", {}, pairs.flatMap(([word, meaning]) => [make("dt", {}, [word]), make("dd", {}, [meaning])]));
}

/**
 * Title, description and the way around the page.
 * @param {Results} results
 */
export function header({ title, description }) {
  const parts = description.split("\n\n").map((part) => part.trim()).filter(Boolean);
  const links = LINKS.map(([id, text]) => make("li", {}, [make("a", { href: `#${id}` }, [text])]));
  const nav = make("nav", { "aria-label": "Sections" }, [make("ul", {}, links)]);
  return make("header", {}, [make("h1", {}, [title]), ...parts.map((part) => paragraph(part)), nav]);
}

/**
 * A verdict as a symbol and in words; the colour says it once more.
 * @param {Verdict} verdict
 */
function badge(verdict) {
  const [kind, text] = VERDICTS[verdict];
  return make("span", { class: `verdict ${kind}` }, [text]);
}

/**
 * All claims with their verdicts.
 * @param {Results} results
 */
export function verdicts({ claims }) {
  if (claims.length === 0) return section("verdicts", "Verdicts", [paragraph("This experiment examines no claim.")]);
  const row = (/** @type {Claim} */ { verdict, claim, found }, /** @type {number} */ i) =>
    make("tr", {}, [
      make("td", {}, [badge(verdict)]),
      make("td", {}, [make("a", { href: `#claim-${i + 1}` }, [claim])]),
      make("td", {}, [found]),
    ]);
  const heads = ["verdict", "claim", "what was found"].map((head) => make("th", { scope: "col" }, [head]));
  const parts = [make("thead", {}, [make("tr", {}, heads)]), make("tbody", {}, claims.map(row))];
  return section("verdicts", "Verdicts", [paragraph(counts(claims)), make("div", { class: "scroll" }, [make("table", {}, parts)])]);
}

/**
 * The number of claims with each verdict.
 * @param {Claim[]} claims
 */
export function counts(claims) {
  const parts = Object.keys(VERDICTS).flatMap((verdict) => {
    const of = claims.filter((claim) => claim.verdict === verdict).length;
    return of > 0 ? [`${of} ${verdict.replaceAll("-", " ")}`] : [];
  });
  return `${count(claims.length, "claim")}: ${parts.join(", ")}.`;
}

/**
 * The comparison: methods, settings, scenes, budgets, seeds and machine.
 * @param {Report} report
 */
export function setting({ results, noises }) {
  const { machine, program, scenes, records } = results;
  const rows = scenes.map(({ name, file, size, digest }) => [name, file, size.join(" × "), digest]);
  const budgets = results.budgets.map(({ name, kind, amount }) => [name, amount, AMOUNTS[kind]]);
  return section("setting", "Comparison", [
    paragraph(extent(results)),
    ...methods(results.methods),
    make("h3", {}, ["Scenes"]),
    tableOf({ caption: "The digest is of every byte that was read for the scene.", columns: ["scene", "file", "pixels", "digest"], rows }),
    ...scenes.map((scene) => reference(scene, noises)),
    make("h3", {}, ["Budgets"]),
    tableOf({ caption: "The amounts that are equal for all methods.", columns: ["budget", "amount", "of"], rows: budgets }),
    make("h3", {}, ["Machine and seeds"]),
    definitions([
      ["Program", program],
      ["Processor", machine.processor],
      ["Threads of each render", String(machine.threads)],
      ["Instruction set of the intersector", machine.isa],
      ["System", machine.system],
      ["Seeds", ranges(records.map(({ seed }) => seed))],
    ]),
  ]);
}

/**
 * The number of renders, with their rays and seconds.
 * @param {Results} results
 */
function extent({ records, scenes, methods, budgets }) {
  const seconds = records.reduce((sum, record) => sum + record.seconds, 0);
  const rays = records.flatMap((record) => Object.values(record.rays)).reduce((sum, rays) => sum + rays, 0);
  const seeds = new Set(records.map(({ seed }) => String(seed))).size;
  const of = [count(scenes.length, "scene"), count(methods.length, "method")].join(", ");
  return `${count(records.length, "render")} of ${of} and ${count(budgets.length, "budget")}, with ${count(seeds, "seed")}: ${number(rays)} rays in ${number(seconds)} seconds.`;
}

/**
 * Settings that differ stand in the table, those that all methods share below it.
 * @param {Method[]} methods
 */
function methods(methods) {
  const names = [...new Set(methods.flatMap(({ settings }) => Object.keys(settings)))].sort();
  const differs = (/** @type {string} */ name) => methods.some(({ settings }) => settings[name] !== methods[0].settings[name]);
  const different = names.filter(differs);
  const shared = names.filter((name) => !differs(name));
  const rows = methods.map(({ name, settings }) => [name, ...different.map((key) => settings[key] ?? NOTHING)]);
  const caption = "Settings that differ between methods; ratios are relative to the first method.";
  return [
    make("h3", {}, ["Methods"]),
    make("div", { class: "differing" }, [tableOf({ caption, columns: ["method", ...different], rows })]),
    make("details", { open: "" }, [
      make("summary", {}, ["Settings that are the same for all methods"]),
      definitions(shared.map((name) => [name, methods[0].settings[name]])),
    ]),
  ];
}

/**
 * The reference of a scene, with its own error.
 * @param {SceneInfo} scene
 * @param {Report["noises"]} noises
 */
function reference(scene, noises) {
  const file = scene.reference_image === null ? "" : ` (${scene.reference_image})`;
  const own = noises.find((noise) => noise.scene === scene.name);
  const part = own ? `, ${number(100 * own.share)} % of the smallest (${own.method}, ${own.budget})` : "";
  const mse = scene.reference_mse;
  const noise = mse === null ? "" : `. The mean square error of its own is ${number(mse)}; it is in that of every image${part}.`;
  return paragraph(make("b", {}, [`Reference of ${scene.name}: `]), `${scene.reference}${file}${noise}`);
}

/**
 * Whole numbers in order, `1–5, 9`. Those that a float cannot hold come as texts.
 * @param {(number | string)[]} numbers
 */
export function ranges(numbers) {
  const sorted = [...new Set(numbers.map(BigInt))].sort((a, b) => (a < b ? -1 : 1));
  /** @type {[bigint, bigint][]} */
  const runs = [];
  for (const number of sorted) {
    const run = runs.at(-1);
    if (run && number === run[1] + 1n) run[1] = number;
    else runs.push([number, number]);
  }
  return runs.map(([first, last]) => (first === last ? String(first) : `${first}–${last}`)).join(", ");
}

/**
 * Claims: what others said, and what was found.
 * @param {Results} results
 */
export function claims({ claims }) {
  if (claims.length === 0) return section("claims", "Claims", [paragraph("This experiment examines no claim.")]);
  return section("claims", "Claims", claims.map(article));
}

/**
 * @param {Claim} claim
 * @param {number} index
 */
function article(claim, index) {
  return make("article", { id: `claim-${index + 1}` }, [
    make("h3", {}, [`${index + 1}. ${claim.claim} `, badge(claim.verdict)]),
    definitions([
      ["Claimed in", claim.source],
      ["Found", claim.found],
      ["How sure", claim.method],
    ]),
    ...claim.tables.map(tableOf),
    ...claim.plots.map(figure),
    note(`In results.json: ${claim.id}`),
  ]);
}

/**
 * Tables and plots that belong to no claim.
 * @param {Report} report
 */
export function others({ tables, plots }) {
  const isEmpty = tables.length + plots.length === 0;
  const children = isEmpty ? [paragraph("There are no others.")] : [...tables.map(tableOf), ...plots.map(figure)];
  return section("more", "More tables and plots", children);
}

/**
 * A plot with its caption and its numbers.
 * @param {Plot} plot
 */
function figure(plot) {
  const frame = frameOf(plot, LARGE);
  const missing = frame ? leftOut(plot, frame) : 0;
  const left = `Points without a place on these axes, left out: ${missing}. They are among the numbers.`;
  return make("figure", {}, [
    frame ? drawing(plot, frame, LARGE) : paragraph("No point of this plot can be drawn."),
    make("figcaption", {}, [plot.caption]),
    ...(missing > 0 ? [note(left)] : []),
    make("details", {}, [make("summary", {}, ["Numbers of this plot"]), tableOf(pointsOf(plot))]),
  ]);
}

/**
 * The points of a plot as a table.
 * @param {Plot} plot
 * @returns {Table}
 */
function pointsOf({ x, y, series }) {
  const rows = series.flatMap(({ name, points, intervals }) =>
    points.map(([at, value], i) => {
      const ends = intervals[i];
      return /** @type {Cell[]} */ ([name, at, ends ? { value, low: ends[0], high: ends[1] } : value]);
    }),
  );
  return { caption: "", columns: ["series", x.label, y.label], rows };
}

/**
 * The command that repeats the experiment.
 * @param {Report} report
 */
export function again({ results, command }) {
  return section("again", "How to reproduce it", [
    paragraph(`With ${results.program} this command renders everything again and writes this page:`),
    make("pre", {}, [make("code", {}, [command])]),
    paragraph(
      "Images are the same bits on every machine, for any number of threads, as far as their budget is in samples. Times are those of the machine above. The scenes are the same if their digests are.",
    ),
  ]);
}

/**
 * Metrics and other words.
 * @param {Report} report
 */
export function glossary({ ratios }) {
  return section("glossary", "Glossary", [
    paragraph("Each metric compares an image with its reference, channel by channel in linear light; 0 is equality, and less is better."),
    definitions([...METRICS, ...words(ratios)]),
  ]);
}
