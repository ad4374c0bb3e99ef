// The picture of a sample: its walks and candidates over the film, and their numbers beside it.

import { box, button, draw, get, input, make, select } from "./dom.js";
import { cell, compact, digits, luminance } from "./format.js";
import { fate, greatest, names, opacity, pieces, rays, width } from "./samplelines.js";
import { toScreen } from "./view.js";

/** @import { Link } from "./link.js" */
/** @import { Fate } from "./samplelines.js" */
/** @import { Lane, LaneName, SampleReport, SampleSubpath, SampleTerm, Status } from "./types.js" */
/** @import { Point, View } from "./view.js" */

/** @type {{[fate in Fate]: string}} */
const WORDS = { chosen: "arrives", blocked: "blocked", left: "not chosen", splat: "light image" };

export class SampleView {
  /**
   * @param {Link} link
   * @param {() => void} redraw
   */
  constructor(link, redraw) {
    this.link = link;
    this.redraw = redraw;
    /** @type {SampleReport | null} */
    this.report = null;
    /** @type {LaneName} Of the report. */
    this.lane = "a";
    /** @type {Lane[]} */
    this.lanes = [];
    /** The ray whose row is pointed at. */
    this.hot = "";
    get("sample-form", HTMLFormElement).addEventListener("submit", (event) => {
      event.preventDefault();
      this.ask();
    });
    button("sample-clear").addEventListener("click", () => this.clear());
  }

  /** @param {Status} status */
  update({ film, split, lanes }) {
    input("sample-x").max = String(film.crop[2] - 1);
    input("sample-y").max = String(film.crop[3] - 1);
    const lane = select("sample-lane");
    lane.disabled = !split;
    if (!split) lane.value = "a";
    this.lanes = lanes;
    if (this.isOld()) this.clear();
  }

  /** A lane that began anew takes other samples; but a report may come before the status of its lane. */
  isOld() {
    const { report, lane, lanes } = this;
    const told = lanes.find((other) => other.lane === lane);
    return report !== null && (!told || told.generation > report.generation);
  }

  /** After a break another server may answer, which counts its renders anew. */
  expire() {
    if (this.report) this.report.generation = 0;
  }

  /** @param {Point} pixel */
  choose([x, y]) {
    input("sample-x").value = String(x);
    input("sample-y").value = String(y);
  }

  clear() {
    this.report = null;
    button("sample-clear").disabled = true;
    box("sample-list").replaceChildren();
    this.redraw();
  }

  async ask() {
    const [x, y, pass] = ["sample-x", "sample-y", "sample-pass"].map((id) => input(id).valueAsNumber);
    if (![x, y, pass].every(Number.isInteger)) return;
    const lane = select("sample-lane").value === "b" ? "b" : "a";
    try {
      this.report = /** @type {SampleReport} */ (await this.link.ask("/sample", { lane, x, y, pass }));
      this.lane = lane;
      box("sample-list").replaceChildren(...this.describe(this.report));
      button("sample-clear").disabled = false;
      if (this.isOld()) this.clear();
    } catch (error) {
      this.report = null;
      box("sample-list").replaceChildren(make("p", {}, [/** @type {Error} */ (error).message]));
    }
    this.redraw();
  }

  /**
   * The drawing, at the places where the film is on the screen.
   * @param {View} view
   * @returns {SVGElement[]}
   */
  drawing(view) {
    const { report } = this;
    if (!report) return [];
    const at = (/** @type {Point} */ point) => toScreen(view, point);
    return [
      ...drawSubpath(report.light, "light-path", "z", at),
      ...drawSubpath(report.camera, "camera-path", "y", at),
      ...rays(report).flatMap((ray) => {
        const [[x1, y1], [x2, y2]] = [at(ray.from), at(ray.to)];
        const hot = ray.name === this.hot ? " hot" : "";
        const style = { "stroke-width": ray.width, "stroke-opacity": ray.opacity };
        return [
          draw("line", { class: "under", x1, y1, x2, y2, "stroke-width": ray.width + 2 }),
          draw("line", { class: `ray ${ray.fate}${hot}`, x1, y1, x2, y2, ...style }),
        ];
      }),
      ...report.light_image.flatMap((splat, i) => {
        const [cx, cy] = at(splat.raster);
        const hot = this.hot === `splat-${i}` ? " hot" : "";
        const state = splat.is_visible ? "splat" : "blocked";
        return draw("circle", { class: `ray ${state}${hot}`, cx, cy, r: 9, "stroke-width": 2 });
      }),
      ...drawNames(report, at),
    ];
  }

  /**
   * The numbers, in tables.
   * @param {SampleReport} report
   */
  describe(report) {
    const [x, y] = report.pixel;
    const [value, all] = [report.value, report.value_of_all_candidates].map((color) => digits(luminance(color), 4));
    const title = `Pixel ${x}, ${y}, pass ${report.pass}: ${report.rays} rays, adds ${value}. Had every connection been traced, connections would have added ${all}. Values are luminances.`;
    const most = greatest(report.candidates);
    const parts = [
      make("p", { class: "hint" }, [title]),
      ...subpathTable("Camera subpath", report.camera, "y"),
      ...subpathTable("Light subpath", report.light, "z"),
      ...this.terms("Connections", report.candidates.map((candidate, i) => ({
        term: candidate,
        name: `candidate-${i}`,
        fate: fate(candidate),
        prob: candidate.prob,
        line: { width: width(candidate, most), opacity: opacity(candidate.prob) },
      }))),
      ...this.terms("Hits of lights", report.hits.map((term, i) => ({ term, name: `hit-${i}`, fate: /** @type {Fate} */ ("chosen"), prob: 1 }))),
      ...this.terms("To the light image", report.light_image.map((term, i) => ({
        term,
        name: `splat-${i}`,
        fate: /** @type {Fate} */ (term.is_visible ? "splat" : "blocked"),
        prob: 1,
      }))),
    ];
    if (report.zeros.length > 0) {
      parts.push(make("p", { class: "hint" }, [`Connections that are zero and need no ray: ${report.zeros.join(", ")}.`]));
    }
    return parts;
  }

  /**
   * A table of strategies' terms; none where there are none.
   * @param {string} title
   * @param {{term: SampleTerm, name: string, fate: Fate, prob: number}[]} rows
   * @returns {HTMLElement[]}
   */
  terms(title, rows) {
    if (rows.length === 0) return [];
    const heads = ["(s, t)", "weight", "value", "chance", "adds", ""].map((name) => make("th", { scope: "col" }, [name]));
    const body = rows.map(({ term, name, fate, prob }) => {
      const texts = [term.weight, luminance(term.value), prob, luminance(term.added)].map(cell);
      const line = make("tr", { tabindex: "0" }, [
        make("th", { scope: "row" }, [`${term.s}, ${term.t}`]),
        ...texts.map((text) => make("td", {}, [text])),
        make("td", { class: `fate ${fate}` }, [WORDS[fate]]),
      ]);
      for (const event of ["pointerenter", "focus"]) line.addEventListener(event, () => this.point(name));
      for (const event of ["pointerleave", "blur"]) line.addEventListener(event, () => this.point(""));
      return line;
    });
    const table = make("table", { class: "terms" }, [
      make("thead", {}, [make("tr", {}, heads)]),
      make("tbody", {}, body),
    ]);
    return [make("h2", {}, [`${title}: ${rows.length}`]), table];
  }

  /** @param {string} name */
  point(name) {
    this.hot = name;
    this.redraw();
  }
}

/**
 * @param {SampleSubpath} subpath
 * @param {string} name
 * @param {string} letter
 * @param {(point: Point) => Point} at
 */
function drawSubpath(subpath, name, letter, at) {
  const lines = pieces(subpath).flatMap((piece) => {
    const points = piece.map((point) => at(point).map((place) => place.toFixed(1)).join(",")).join(" ");
    return [
      draw("polyline", { class: "under", points, "stroke-width": 5 }),
      draw("polyline", { class: name, points }),
    ];
  });
  const dots = names(subpath, letter).map(({ at: point }) => {
    const [cx, cy] = at(point);
    return draw("circle", { class: name, cx, cy, r: 4.5 });
  });
  return [...lines, ...dots];
}

/**
 * @param {SampleReport} report
 * @param {(point: Point) => Point} at
 */
function drawNames({ camera, light }, at) {
  return [...names(light, "z"), ...names(camera, "y")].map(({ name, at: point }) => {
    const [x, y] = at(point);
    return draw("text", { x: x + 7, y: y - 7 }, [name]);
  });
}

/**
 * @param {string} title
 * @param {SampleSubpath} subpath
 * @param {string} letter
 * @returns {HTMLElement[]}
 */
function subpathTable(title, subpath, letter) {
  const count = subpath.vertices.length;
  if (count === 0) return [];
  const heads = ["", "β", "at", "on the film"].map((name) => make("th", { scope: "col" }, [name]));
  const rows = subpath.vertices.map((vertex, i) => {
    const place = vertex.position.map((part) => digits(part, 3)).join(" ");
    const raster = vertex.raster ? vertex.raster.map((part) => part.toFixed(0)).join(", ") : "–";
    const kind = vertex.is_delta ? `${vertex.kind}, delta` : vertex.kind;
    const name = make("th", { scope: "row", title: kind }, [`${letter}${i} ${kind}`]);
    return make("tr", {}, [name, ...[cell(luminance(vertex.beta)), place, raster].map((text) => make("td", {}, [text]))]);
  });
  const table = make("table", { class: "terms" }, [make("thead", {}, [make("tr", {}, heads)]), make("tbody", {}, rows)]);
  const escape = subpath.escape ? ", then it leaves the scene" : "";
  return [make("h2", {}, [`${title}: ${compact(count)} vertices${escape}`]), table];
}
