// The pyramid of strategies: an image of what each (s, t) adds, a row for each number of vertices.

import { box, button, get, input, make, say, select } from "./dom.js";
import { count, digits } from "./format.js";
import { figuresOf, meaning, rowName, rowOf, rowsOf } from "./tiles.js";

/** @import { Link } from "./link.js" */
/** @import { LaneName, Lane, Status, StrategyReport, StrategyTile } from "./types.js" */

/** The least time between two looks. Unit: milliseconds. */
const PATIENCE = 2000;

export class Pyramid {
  /** @param {Link} link */
  constructor(link) {
    this.link = link;
    /** @type {Lane[]} */
    this.lanes = [];
    this.known = "";
    this.asked = 0;
    this.connect();
  }

  connect() {
    get("strategies-form", HTMLFormElement).addEventListener("submit", (event) => {
      event.preventDefault();
      this.keep(input("strategy-vertices").valueAsNumber);
    });
    button("strategies-drop").addEventListener("click", () => this.keep(0));
    for (const id of ["strategies-lane", "strategies-kind", "strategies-exposure"]) {
      box(id).addEventListener("input", () => this.ask());
    }
  }

  /** @param {number} vertices */
  keep(vertices) {
    this.link.send("strategies", { lane: this.lane, vertices });
  }

  /** @returns {LaneName} */
  get lane() {
    return select("strategies-lane").value === "b" ? "b" : "a";
  }

  get isShown() {
    return !box("panel-strategies").hidden;
  }

  /** @param {Status} status */
  update({ lanes, split }) {
    this.lanes = lanes;
    const list = select("strategies-lane");
    list.disabled = !split;
    if (!split) list.value = "a";
    this.look();
  }

  /** Looks again where there is something new. */
  look() {
    const lane = this.lanes.find(({ lane }) => lane === this.lane);
    if (!lane || !this.isShown) return;
    const isKept = lane.strategyVertices > 0;
    box("strategies-look").hidden = !isKept && this.lanes.length < 2;
    button("strategies-drop").hidden = !isKept;
    if (!isKept) return this.explain();
    const state = `${lane.lane} ${lane.generation}/${lane.passes}`;
    if (state === this.known || performance.now() - this.asked < PATIENCE) return;
    this.known = state;
    this.ask();
  }

  explain() {
    this.known = "";
    box("pyramid").replaceChildren();
    say(
      box("strategies-hint"),
      "A path of s + t vertices has s from the light and t from the camera. Images of all strategies need memory and restart the render; bdpt and lvc have them.",
    );
  }

  get query() {
    const exposure = input("strategies-exposure").valueAsNumber;
    return {
      lane: this.lane,
      kind: select("strategies-kind").value,
      exposure: Number.isFinite(exposure) ? exposure : 0,
    };
  }

  async ask() {
    this.asked = performance.now();
    try {
      const { lane } = this;
      const report = /** @type {StrategyReport} */ (await this.link.ask("/strategies", { lane }));
      this.show(report);
    } catch (error) {
      say(box("strategies-hint"), /** @type {Error} */ (error).message);
    }
  }

  /** @param {StrategyReport} report */
  show(report) {
    const { kind } = this.query;
    const told =
      kind === "weighted"
        ? "The contribution of each strategy: all tiles and longer paths add up to the image."
        : "Each strategy alone, without its weight: the same light all along a row, as far as it can make its paths.";
    say(box("strategies-hint"), `${told} Longer paths: mean ${digits(report.longerMean, 3)}. ${count(report.passes, "pass")}.`);
    const rows = rowsOf(report.tiles);
    const isSame = box("pyramid").childElementCount === 2 * rows.length;
    if (!isSame) box("pyramid").replaceChildren(...rows.flatMap(([vertices, tiles]) => this.row(vertices, tiles)));
    for (const tile of report.tiles) this.fill(tile, report);
  }

  /**
   * @param {number} vertices
   * @param {StrategyTile[]} tiles
   */
  row(vertices, tiles) {
    const buttons = tiles.map(({ s, t }) =>
      make("button", { type: "button", class: "tile", id: `tile-${s}-${t}` }, [
        make("img", { alt: "" }),
        make("b", {}, [`s = ${s}, t = ${t}`]),
        ...figuresOf(tiles[0]).map(() => make("span")),
      ]),
    );
    return rowOf(rowName(vertices), buttons);
  }

  /**
   * @param {StrategyTile} tile
   * @param {StrategyReport} report
   */
  fill(tile, report) {
    const element = document.getElementById(`tile-${tile.s}-${tile.t}`);
    const image = element?.querySelector("img");
    if (!element || !image) return;
    const version = `${report.generation}.${report.passes}`;
    image.src = this.link.url("/strategies.png", { ...this.query, s: tile.s, t: tile.t, version });
    const figures = figuresOf(tile);
    element.querySelectorAll("span").forEach((span, i) => say(span, figures[i]));
    element.setAttribute("aria-label", `Strategy s = ${tile.s}, t = ${tile.t}, ${meaning(tile)}: ${figures.join(", ")}. Enlarge`);
    element.onclick = () => enlarge(tile, image.src);
  }
}

/**
 * @param {StrategyTile} tile
 * @param {string} source
 */
function enlarge(tile, source) {
  say(box("large-title"), `s = ${tile.s}, t = ${tile.t}: ${meaning(tile)}`);
  const image = get("large-image", HTMLImageElement);
  image.src = source;
  image.alt = `Image of the strategy s = ${tile.s}, t = ${tile.t}`;
  say(box("large-figures"), figuresOf(tile).join(" · "));
  get("large", HTMLDialogElement).showModal();
}
