// The inspector: what is known of one pixel, in each lane.

import { box, get, input, make } from "./dom.js";
import { compact, count, exact, luminance, percent } from "./format.js";

/** @import { Link } from "./link.js" */
/** @import { LaneName, PixelReport, Status } from "./types.js" */
/** @import { Point } from "./view.js" */

/** The least time between two questions about the same pixel. Unit: milliseconds. */
const PATIENCE = 500;

export class Inspector {
  /**
   * @param {Link} link
   * @param {(pixel: Point) => void} onChoose
   */
  constructor(link, onChoose) {
    this.link = link;
    /** @type {Point | null} */
    this.pixel = null;
    /** @type {LaneName[]} */
    this.lanes = [];
    /** The data of the tables. */
    this.known = "";
    this.asked = 0;
    get("pixel-form", HTMLFormElement).addEventListener("submit", (event) => {
      event.preventDefault();
      onChoose([input("pixel-x").valueAsNumber, input("pixel-y").valueAsNumber]);
    });
  }

  /** @param {Point} pixel */
  choose(pixel) {
    this.pixel = pixel;
    input("pixel-x").value = String(pixel[0]);
    input("pixel-y").value = String(pixel[1]);
    box("pixel-tables").dataset.pixel = "";
    this.ask();
  }

  /**
   * Asks again where passes were added.
   * @param {Status} status
   */
  update({ film, lanes }) {
    input("pixel-x").max = String(film.crop[2] - 1);
    input("pixel-y").max = String(film.crop[3] - 1);
    // Before the first pass nothing is known of any pixel.
    this.lanes = lanes.filter(({ passes }) => passes > 0).map(({ lane }) => lane);
    const state = lanes.map(({ generation, passes }) => `${generation}/${passes}`).join(" ");
    if (state === this.known || performance.now() - this.asked < PATIENCE) return;
    this.known = state;
    this.ask();
  }

  async ask() {
    const { pixel } = this;
    if (!pixel || this.lanes.length === 0) return;
    this.asked = performance.now();
    const [x, y] = pixel;
    const told = await Promise.all(
      this.lanes.map((lane) =>
        this.link.ask("/pixel", { lane, x, y }).then(
          (/** @type {PixelReport} */ report) => table(lane, report),
          (/** @type {Error} */ error) => make("p", { class: "hint" }, [`${lane}: ${error.message}`]),
        ),
      ),
    );
    // Another one was chosen meanwhile.
    if (this.pixel !== pixel) return;
    const tables = box("pixel-tables");
    tables.replaceChildren(...told);
    tables.dataset.pixel = `${x},${y}`;
  }
}

/**
 * @param {LaneName} lane
 * @param {PixelReport} report
 */
function table(lane, report) {
  const { mean, standardError, samples, passes, rays } = report;
  const row = (/** @type {string} */ name, /** @type {string[]} */ texts) =>
    make("tr", {}, [make("th", { scope: "row" }, [name]), ...texts.map((text) => make("td", {}, [text]))]);
  const [l, e] = [luminance(mean), luminance(standardError)];
  return make("table", { class: "pixel", "data-lane": lane }, [
    make("thead", {}, [
      make("tr", {}, [
        make("th", {}, [make("span", { class: `badge ${lane}` }, [lane])]),
        make("th", { scope: "col" }, ["mean"]),
        make("th", { scope: "col" }, ["standard error"]),
      ]),
    ]),
    make("tbody", {}, [
      ...["Red", "Green", "Blue"].map((name, i) => row(name, [exact(mean[i]), `± ${exact(standardError[i])}`])),
      row("Luminance", [exact(l), l > 0 ? `about ${percent(e / l)}` : "–"]),
      row("Samples", [String(samples), count(passes, "pass")]),
      row("Rays", rays === null ? ["–", ""] : [compact(rays), samples > 0 ? `${compact(rays / samples)} a sample` : ""]),
    ]),
  ]);
}
