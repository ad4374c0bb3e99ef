// The stage: what part of the film is seen, and how; it draws when something changed.

import { box, get, input, make, say, select } from "./dom.js";
import { magma, marks } from "./falsecolor.js";
import { digits } from "./format.js";
import { Picture } from "./picture.js";
import { centred, clamp, fit, pan, pixelAt, toScreen, zoomAt } from "./view.js";

/** @import { Frame } from "./pixels.js" */
/** @import { Point, View } from "./view.js" */

/**
 * The film of a stage; `split`: lane b is beside lane a.
 * @typedef {{film: {resolution: [number, number], crop: [number, number, number, number]}, split: boolean}} Scenery
 */

export class Stage {
  /** @param {(reason: string) => void} onGiveUp */
  constructor(onGiveUp) {
    this.onGiveUp = onGiveUp;
    this.element = box("stage");
    this.canvas = get("canvas", HTMLCanvasElement);
    this.picture = Picture.on(this.canvas);
    /** @type {[number, number]} */
    this.film = [1, 1];
    /** @type {[number, number, number, number]} */
    this.crop = [0, 0, 1, 1];
    /** @type {View} */
    this.view = { zoom: 1, offset: [0, 0] };
    /** The whole film is shown, however large the stage is. */
    this.isFitted = true;
    /** The left border of lane b, as a share of the stage's width. */
    this.divide = 0.5;
    /** @type {Point | null} The pixel that was chosen. */
    this.pixel = null;
    /** @type {(() => void)[]} */
    this.listeners = [];
    this.isWaiting = false;
    this.connect();
  }

  connect() {
    new ResizeObserver(() => this.resize()).observe(this.element);
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.picture?.prepare();
      this.redraw();
    });
    input("exposure").addEventListener("input", () => this.redraw());
    select("operator").addEventListener("input", () => this.redraw());
    box("zoom-in").addEventListener("click", () => this.zoom(Math.SQRT2));
    box("zoom-out").addEventListener("click", () => this.zoom(Math.SQRT1_2));
    box("zoom-fit").addEventListener("click", () => this.fit());
    box("zoom-one").addEventListener("click", () => this.oneToOne());
  }

  /** The mapping of light to colours. */
  get look() {
    return { exposure: Number(input("exposure").value), operator: select("operator").value };
  }

  /** @returns {[number, number]} */
  get size() {
    return [this.element.clientWidth, this.element.clientHeight];
  }

  /** @param {number} stops */
  expose(stops) {
    input("exposure").value = String(this.look.exposure + stops);
    this.redraw();
  }

  /** @param {Scenery} scenery */
  update({ film, split }) {
    const isOther = String(film.resolution) !== String(this.film);
    this.film = film.resolution;
    this.crop = film.crop;
    if (!split && this.picture?.frame("b")) this.picture.drop("b");
    if (isOther) this.fit();
    this.redraw();
  }

  /** @param {Frame} frame */
  take(frame) {
    const { picture } = this;
    if (!picture) return;
    if (Math.max(...frame.size) > picture.largest) return this.giveUp("The film is larger than this browser’s textures");
    picture.take(frame);
    this.redraw();
  }

  /**
   * Draws nothing any more, and says why.
   * @param {string} reason
   */
  giveUp(reason) {
    this.picture = null;
    this.canvas.hidden = true;
    this.onGiveUp(reason);
    this.redraw();
  }

  resize() {
    const density = window.devicePixelRatio || 1;
    for (const canvas of [this.canvas, get("values", HTMLCanvasElement)]) {
      canvas.width = Math.max(1, Math.round(this.size[0] * density));
      canvas.height = Math.max(1, Math.round(this.size[1] * density));
    }
    if (this.isFitted) this.fit();
    // A canvas that was given a size is empty: it is drawn before the browser shows it.
    this.draw();
  }

  fit() {
    this.isFitted = true;
    this.show(fit(this.film, this.size));
  }

  oneToOne() {
    this.isFitted = false;
    this.show(centred(this.film, this.size, 1 / (window.devicePixelRatio || 1)));
  }

  /**
   * @param {number} factor
   * @param {Point} about
   */
  zoom(factor, about = [this.size[0] / 2, this.size[1] / 2]) {
    this.isFitted = false;
    this.show(zoomAt(this.view, factor, about));
  }

  /** @param {Point} by */
  pan(by) {
    this.isFitted = false;
    this.show(pan(this.view, by, this.film, this.size));
  }

  /** @param {View} view */
  show(view) {
    this.view = view;
    this.redraw();
  }

  /**
   * The pixel under a point of the stage.
   * @param {Point} screen
   */
  at(screen) {
    return pixelAt(this.view, screen, this.crop);
  }

  /**
   * Chooses a pixel, or the nearest one that is rendered.
   * @param {Point} pixel
   */
  choose([x, y]) {
    const [x0, y0, x1, y1] = this.crop;
    /** @type {Point} */
    const chosen = [clamp(x, x0, x1 - 1), clamp(y, y0, y1 - 1)];
    this.pixel = chosen;
    this.keepInSight(chosen);
    this.redraw();
    return chosen;
  }

  /** @param {Point} pixel */
  keepInSight([x, y]) {
    const place = toScreen(this.view, [x + 0.5, y + 0.5]);
    const out = place.map((at, axis) => at - clamp(at, 8, this.size[axis] - 8));
    if (out[0] !== 0 || out[1] !== 0) this.pan([-out[0], -out[1]]);
  }

  redraw() {
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.draw();
    });
  }

  draw() {
    const { look, view } = this;
    const density = window.devicePixelRatio || 1;
    this.picture?.draw(view, look, this.film, this.divide * this.size[0], density);
    say(box("exposure-value"), `${look.exposure > 0 ? "+" : ""}${look.exposure}`);
    say(box("zoom-value"), `${digits(view.zoom * density, 3)}×`);
    this.drawLegend();
    for (const listener of this.listeners) listener();
  }

  /**
   * The labels at the colours of the scale. Null: the picture has none.
   * @returns {string[] | null}
   */
  scale() {
    const { exposure, operator } = this.look;
    return operator === "false" ? marks(exposure).map(({ value }) => digits(value, 2)) : null;
  }

  drawLegend() {
    const legend = box("legend");
    const labels = this.picture && this.scale();
    legend.hidden = !labels;
    if (!labels || legend.dataset.labels === String(labels)) return;
    legend.dataset.labels = String(labels);
    const ramp = get("ramp", HTMLCanvasElement);
    const context = ramp.getContext("2d");
    for (let x = 0; context && x < ramp.width; x++) {
      context.fillStyle = magma(x / (ramp.width - 1));
      context.fillRect(x, 0, 1, ramp.height);
    }
    box("marks").replaceChildren(...labels.map((label) => make("span", {}, [label])));
  }

  /**
   * The film as it is shown, pixel by pixel, as PNG. Null where nothing can be drawn.
   * @returns {Promise<Blob | null>}
   */
  shot() {
    const { canvas, picture } = this;
    if (!picture) return Promise.resolve(null);
    const [x0, y0, x1, y1] = this.crop;
    [canvas.width, canvas.height] = [x1 - x0, y1 - y0];
    const border = clamp((this.divide * this.size[0] - this.view.offset[0]) / this.view.zoom - x0, 0, x1 - x0);
    picture.draw({ zoom: 1, offset: [-x0, -y0] }, this.look, this.film, border, 1);
    const taken = new Promise((/** @type {(blob: Blob | null) => void} */ resolve) => canvas.toBlob(resolve));
    this.resize();
    return taken;
  }
}
