// The images of a report: two of a scene, flipped at the same place or side by side, as light or as
// errors against the reference.

import { connectDivider, placeDivider } from "./divider.js";
import { box, button, input, make, say, select } from "./dom.js";
import { digits } from "./format.js";
import { Gestures } from "./gestures.js";
import { bytesOf, halves } from "./pixels.js";
import { note, paragraph, section } from "./sections.js";
import { Stage } from "./stage.js";
import { drawValues } from "./values.js";
import { centred } from "./view.js";

/** @import { LaneName } from "./pixels.js" */
/** @import { Report, StoredImage } from "./results.js" */
/** @import { Point } from "./view.js" */

/** @typedef {"image" | "relative" | "flip"} Layer */

const LAYERS = [["image", "image"], ["relative", "relative square error"], ["flip", "FLIP error (HDR)"]];

const TONES = [["srgb", "sRGB"], ["agx", "AgX"], ["neutral", "PBR Neutral"], ["linear", "linear"], ["false", "false colour"]];

const KEYS = [
  ["F, Space", "flips between A and B"],
  ["1 – 9", "shows the first … ninth image of the scene in place of the one that is shown"],
  ["S", "divides the image: A to the left, B to the right"],
  ["E", "shows the next error map"],
  ["[ ]", "darker, brighter by half a stop"],
  ["+ −", "larger, smaller; the wheel with Ctrl and two fingers do so, too"],
  ["← ↑ → ↓", "move the image, as dragging does"],
  ["R", "puts everything back"],
];

/** The relative errors that have the darkest and the brightest colour. */
const RELATIVE_RANGE = [1e-4, 1e1];

/** An image whose pixels are decoded when they are first asked for. */
export class Image {
  /** @param {StoredImage} stored */
  constructor(stored) {
    this.stored = stored;
    /** @type {Float32Array | null} */
    this.decoded = null;
    /** The computed maps of `errors`. @type {Map<Layer, Float32Array | null>} */
    this.known = new Map();
  }

  /** Three channels for each pixel, row by row from the top left. */
  get channels() {
    return (this.decoded ??= halves(this.stored.halves));
  }

  /**
   * The errors of all pixels against the reference of the scene. Null: they are not known.
   * @param {Layer} layer
   * @param {Image | undefined} reference
   */
  errors(layer, reference) {
    const known = this.known.get(layer);
    if (known !== undefined) return known;
    const errors = layer === "flip" ? this.flip() : this.relative(reference);
    this.known.set(layer, errors);
    return errors;
  }

  flip() {
    const { flip, size, is_reference } = this.stored;
    if (is_reference) return new Float32Array(size[0] * size[1]);
    return flip === null ? null : Float32Array.from(bytesOf(flip), (byte) => (byte === 255 ? NaN : byte / 254));
  }

  /**
   * For every pixel the mean over the channels of (a - b)² / (b² + 0.01).
   * @param {Image | undefined} reference
   */
  relative(reference) {
    if (!reference || String(reference.stored.size) !== String(this.stored.size)) return null;
    const [a, b] = [this.channels, reference.channels];
    const of = (/** @type {number} */ i) => (a[i] - b[i]) ** 2 / (b[i] ** 2 + 0.01);
    return Float32Array.from({ length: a.length / 3 }, (_, pixel) => (of(3 * pixel) + of(3 * pixel + 1) + of(3 * pixel + 2)) / 3);
  }
}

/**
 * The place of an error between the darkest and the brightest colour.
 * @param {Layer} layer
 * @param {number} error
 */
export function share(layer, error) {
  if (layer === "flip" || Number.isNaN(error)) return error;
  const [low, high] = RELATIVE_RANGE;
  return Math.log(Math.max(error, low) / low) / Math.log(high / low);
}

/**
 * The section; `connectImages` makes it work once it is in the page.
 * @param {Report} report
 */
export function images({ images, most_flip_pixels }) {
  if (images.length === 0) return section("viewer", "Images", [paragraph("No images were kept.")]);
  const renders = images.filter((image) => !image.is_reference);
  const missing = renders.filter((image) => image.flip === null).length;
  const words = `${missing} of ${renders.length} renders have no map of FLIP here: their scene has no reference of their size among the results, or the maps of those before have ${most_flip_pixels} pixels. bidir compare --flip hdr --error-map computes it from the images.`;
  return section("viewer", "Images", [
    make("div", { class: "controls" }, controls()),
    make("p", { class: "shown" }, [make("output", { id: "shown", "aria-live": "polite" })]),
    stageOf(),
    make("div", { id: "legend", hidden: "" }, [make("canvas", { id: "ramp", width: "256", height: "1" }), make("div", { id: "marks" })]),
    make("pre", { id: "figures" }, ["\n\n\n"]),
    ...(missing > 0 ? [note(words)] : []),
    make("details", { id: "keys" }, [
      make("summary", {}, ["Keys, while the image has the focus"]),
      make("dl", {}, KEYS.flatMap(([key, text]) => [make("dt", {}, [make("kbd", {}, [key])]), make("dd", {}, [text])])),
      note("Pixels are stored with 11 bits of precision and up to 65504; pixels that are not numbers are green. Error maps and means here are computed from these, so their last digits may differ from those in the tables."),
    ]),
  ]);
}

function controls() {
  const labelled = (/** @type {string} */ text, /** @type {HTMLElement[]} */ ...parts) => make("label", {}, [make("span", {}, [text]), ...parts]);
  const choice = (/** @type {string} */ id, /** @type {string} */ text, /** @type {string[][]} */ options = []) =>
    labelled(text, make("select", { id }, options.map(([value, words]) => make("option", { value }, [words]))));
  const push = (/** @type {string} */ id, /** @type {string} */ text, attributes = {}) => make("button", { type: "button", id, ...attributes }, [text]);
  const exposure = { type: "range", id: "exposure", min: "-10", max: "10", step: "0.25", value: "0" };
  const row = (/** @type {HTMLElement[]} */ ...parts) => make("div", { class: "row" }, parts);
  return [
    row(choice("scene", "Scene"), choice("image-a", "A"), choice("image-b", "B"), push("flip", "Flip A/B"), labelled("Divide", make("input", { type: "checkbox", id: "is-split" })), push("reset", "Reset")),
    row(
      choice("layer", "Show", LAYERS),
      choice("operator", "Tone", TONES),
      labelled("Exposure", make("input", exposure), make("output", { id: "exposure-value" })),
      push("zoom-out", "−", { "aria-label": "smaller" }),
      make("output", { id: "zoom-value" }),
      push("zoom-in", "+", { "aria-label": "larger" }),
      push("zoom-fit", "Fit"),
      push("zoom-one", "1:1"),
    ),
  ];
}

function stageOf() {
  const divider = { id: "divider", role: "slider", tabindex: "0", "aria-label": "Border between A and B", "aria-orientation": "horizontal", "aria-valuemin": "0", "aria-valuemax": "100", hidden: "" };
  return make("div", { id: "stage", tabindex: "0", role: "application", "aria-label": "Image", "aria-describedby": "keys" }, [
    make("canvas", { id: "canvas" }),
    make("canvas", { id: "values" }),
    make("div", divider),
  ]);
}

/** The stage with the images of one scene. */
class Flipping extends Stage {
  /** @param {StoredImage[]} stored */
  constructor(stored) {
    super(() => say(box("shown"), "This browser has no WebGL2, which shows the images; they are files in the folder of the results, too."));
    this.stored = stored;
    /** @type {Image[]} */
    this.images = [];
    /** Which one is shown, where the picture is not divided. @type {LaneName} */
    this.side = "a";
    /** @type {Point | null} */
    this.hovered = null;
    this.listeners.push(() => {
      placeDivider(this);
      if (this.layer === "image") drawValues(this);
    });
  }

  get layer() {
    return /** @type {Layer} */ (select("layer").value);
  }

  get look() {
    return this.layer === "image" ? super.look : { exposure: 0, operator: "errors" };
  }

  /** @param {number} stops */
  expose(stops) {
    if (this.layer === "image") super.expose(stops);
  }

  get isSplit() {
    return input("is-split").checked;
  }

  get reference() {
    return this.images.find(({ stored }) => stored.is_reference);
  }

  /** @param {LaneName} side */
  image(side) {
    return this.images[select(`image-${side}`).selectedIndex];
  }

  scale() {
    if (this.layer === "image") return super.scale();
    const [low, high] = RELATIVE_RANGE;
    return this.layer === "flip" ? ["0", "0.25", "0.5", "0.75", "1"] : [`≤ ${low}`, "logarithmic", `≥ ${high}`];
  }

  /**
   * Lists the images of the chosen scene: A and B are what they were in the scene before, if this
   * one has it; otherwise the first method, and the reference where there is one.
   */
  open() {
    const before = /** @type {LaneName[]} */ (["a", "b"]).map((side) => this.image(side)?.stored.name);
    const scene = select("scene").value;
    this.images = this.stored.filter((image) => image.scene === scene).map((image) => new Image(image));
    const at = (/** @type {(stored: StoredImage) => boolean} */ isIt) => this.images.findIndex(({ stored }) => isIt(stored));
    const usual = [at((image) => !image.is_reference), at((image) => image.is_reference)];
    ["a", "b"].forEach((side, i) => {
      // The first nine have a key.
      const options = this.images.map(({ stored }, n) => make("option", { value: String(n) }, [n < 9 ? `${n + 1}: ${stored.name}` : stored.name]));
      const list = select(`image-${side}`);
      list.replaceChildren(...options);
      const kept = at(({ name }) => name === before[i]);
      list.selectedIndex = kept >= 0 ? kept : usual[i] >= 0 ? usual[i] : i * (this.images.length - 1);
    });
    this.apply();
    this.fit();
  }

  /** The whole image, as large as whole multiples of pixels allow. */
  fit() {
    super.fit();
    const density = window.devicePixelRatio || 1;
    const whole = Math.floor(this.view.zoom * density) / density;
    if (whole > 0) this.show(centred(this.film, this.size, whole));
  }

  /** Puts everything but the choice of images back. */
  reset() {
    select("layer").value = "image";
    select("operator").value = "srgb";
    input("exposure").value = "0";
    input("is-split").checked = false;
    this.divide = 0.5;
    this.side = "a";
    this.apply();
    this.fit();
  }

  flip() {
    this.side = this.side === "a" ? "b" : "a";
    input("is-split").checked = false;
    this.apply();
  }

  /** Takes over what the controls say. */
  apply() {
    const sides = /** @type {LaneName[]} */ (this.isSplit ? ["a", "b"] : [this.side]);
    const [width, height] = this.image("a").stored.size;
    this.update({ film: { resolution: [width, height], crop: [0, 0, width, height] }, split: this.isSplit });
    sides.forEach((side, i) => this.put(this.image(side), i === 0 ? "a" : "b"));
    button("flip").setAttribute("aria-pressed", String(this.side === "b"));
    input("exposure").disabled = this.layer !== "image";
    select("operator").disabled = this.layer !== "image";
    say(box("shown"), sides.map((side) => `${side.toUpperCase()}: ${this.described(this.image(side))}`).join("   |   "));
    this.tell();
  }

  /**
   * @param {Image} image
   * @param {LaneName} lane
   */
  put(image, lane) {
    const { layer } = this;
    const { size } = image.stored;
    const errors = layer === "image" ? null : image.errors(layer, this.reference);
    if (layer !== "image" && !errors) return this.picture?.drop(lane);
    const channels = errors ? Float32Array.from({ length: 3 * errors.length }, (_, i) => share(layer, errors[Math.floor(i / 3)])) : image.channels;
    this.take({ lane, resolution: size, origin: [0, 0], size, channels });
  }

  /**
   * The name of an image with the mean of its errors.
   * @param {Image} image
   */
  described(image) {
    const { name } = image.stored;
    if (this.layer === "image" || image === this.reference) return name;
    const errors = image.errors(this.layer, this.reference);
    return errors ? `${name}, mean ${digits(errors.reduce((sum, error) => sum + error, 0) / errors.length, 4)}` : `${name}, not known`;
  }

  /** Shows the numbers of the pixel under the pointer. */
  tell() {
    const pixel = this.hovered;
    const line = (/** @type {string} */ word, /** @type {Image | undefined} */ image) => {
      if (!pixel || !image) return "";
      const [width, height] = image.stored.size;
      if (pixel[0] >= width || pixel[1] >= height) return `${word} has no such pixel`;
      const at = 3 * (pixel[1] * width + pixel[0]);
      return word.padEnd(10) + [...image.channels.slice(at, at + 3)].map((channel) => String(Number(channel.toPrecision(4))).padStart(10)).join("");
    };
    const place = pixel ? `pixel (${pixel.join(", ")})` : "pixel: point at the image";
    box("figures").textContent = [place, line("A", this.image("a")), line("B", this.image("b")), line("reference", this.reference)].join("\n");
  }
}

/** Hands that flip and choose, too. */
class Hands extends Gestures {
  /** @param {Flipping} stage */
  constructor(stage) {
    super(stage);
    this.shown = stage;
  }

  /** @param {Point | null} pixel */
  onHover(pixel) {
    this.shown.hovered = pixel;
    this.shown.tell();
  }

  /**
   * Without Ctrl the wheel scrolls the page, as everywhere else.
   * @param {WheelEvent} event
   */
  wheel(event) {
    if (event.ctrlKey) super.wheel(event);
  }

  actions() {
    const stage = this.shown;
    const divide = () => {
      input("is-split").checked = !stage.isSplit;
      stage.apply();
    };
    const next = () => {
      const layer = select("layer");
      layer.selectedIndex = (layer.selectedIndex + 1) % layer.length;
      stage.apply();
    };
    const own = /** @type {[string, () => void][]} */ ([["f", () => stage.flip()], [" ", () => stage.flip()], ["s", divide], ["e", next], ["r", () => stage.reset()]]);
    // A digit puts an image in place of the one that is shown.
    const digits = stage.images.slice(0, 9).map((_, i) => {
      const choose = () => {
        select(`image-${stage.side}`).selectedIndex = i;
        stage.apply();
      };
      return /** @type {[string, () => void]} */ ([String(i + 1), choose]);
    });
    return new Map([...super.actions(), ...own, ...digits]);
  }
}

/**
 * Makes the section work.
 * @param {Report} report
 */
export function connectImages({ images }) {
  if (images.length === 0) return;
  const scenes = [...new Set(images.map(({ scene }) => scene))];
  select("scene").replaceChildren(...scenes.map((scene) => make("option", { value: scene }, [scene])));
  const stage = new Flipping(images);
  new Hands(stage);
  connectDivider(stage);
  select("scene").addEventListener("input", () => stage.open());
  for (const id of ["image-a", "image-b", "layer", "is-split"]) box(id).addEventListener("input", () => stage.apply());
  button("flip").addEventListener("click", () => stage.flip());
  button("reset").addEventListener("click", () => stage.reset());
  stage.open();
  if (!stage.picture) stage.giveUp("");
}
