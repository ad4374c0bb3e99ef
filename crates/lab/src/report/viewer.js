// The viewer: controls, keys and the pointer change the view; then everything is shown anew.

/**
 * The element with an id, which the page has.
 * @template {Element} T
 * @param {string} id
 * @param {new () => T} type
 */
function byId(id, type) {
  const element = document.getElementById(id);
  if (!(element instanceof type)) throw new Error(`the page has no ${id}`);
  return element;
}

/**
 * A number as it is shown.
 * @param {number} number
 */
function written(number) {
  return Number.isFinite(number) ? String(Number(number.toPrecision(4))) : String(number);
}

/** The viewer of a page that has images. */
class Viewer {
  /** @param {StoredScene[]} scenes */
  constructor(scenes) {
    this.scenes = scenes;
    this.canvas = byId("canvas", HTMLCanvasElement);
    this.select = {
      scene: byId("scene", HTMLSelectElement),
      a: byId("image-a", HTMLSelectElement),
      b: byId("image-b", HTMLSelectElement),
      layer: byId("layer", HTMLSelectElement),
      curve: byId("curve", HTMLSelectElement),
    };
    this.input = {
      exposure: byId("exposure", HTMLInputElement),
      split: byId("split", HTMLInputElement),
      isSplit: byId("is-split", HTMLInputElement),
    };
    this.flipButton = byId("flip", HTMLButtonElement);
    this.select.scene.append(...scenes.map((scene) => new Option(scene.name)));
    /** @type {Picture[]} */
    this.images = [];
    /** @type {[number, number] | null} */
    this.pixel = null;
    this.view = this.openScene();
    this.reset();
    this.listen();
  }

  /**
   * Lists the images of the chosen scene: A and B are what they were in the scene before, if this
   * one has it; otherwise the first method, and the reference where there is one.
   */
  openScene() {
    const scene = this.scenes[this.select.scene.selectedIndex];
    const before = [this.select.a, this.select.b].map((select) => this.images[select.selectedIndex]?.name);
    painted.clear();
    this.images = scene.images.map((stored) => new Picture(stored));
    for (const select of [this.select.a, this.select.b]) select.replaceChildren(...this.options());
    const reference = this.images.findIndex((image) => image.stored.is_reference);
    const render = this.images.findIndex((image) => !image.stored.is_reference);
    const [a, b] = before.map((name) => this.images.findIndex((image) => image.name === name));
    this.select.a.selectedIndex = a >= 0 ? a : Math.max(render, 0);
    this.select.b.selectedIndex = b >= 0 ? b : reference >= 0 ? reference : this.images.length - 1;
    this.pixel = null;
    /** @type {View} */
    const view = {
      a: this.images[this.select.a.selectedIndex],
      b: this.images[this.select.b.selectedIndex],
      reference: this.images[reference],
      side: "a",
      isSplit: false,
      split: 0.5,
      layer: "image",
      curve: "srgb",
      exposure: 0,
      zoom: 1,
      x: 0,
      y: 0,
    };
    return view;
  }

  /** The images to choose from; the first nine tell their key. */
  options() {
    return this.images.map((image, index) => {
      const key = index < 9 ? `${index + 1}: ` : "";
      return new Option(key + image.name, String(index));
    });
  }

  /** Puts everything but the choice of images back. */
  reset() {
    this.select.layer.value = "image";
    this.select.curve.value = "srgb";
    this.input.exposure.value = "0";
    this.input.split.value = "0.5";
    this.input.isSplit.checked = false;
    this.view.side = "a";
    fit(this.view, this.canvas);
    this.update();
  }

  /** Takes over what the controls say, and shows it. */
  update() {
    const view = this.view;
    view.a = this.images[this.select.a.selectedIndex];
    view.b = this.images[this.select.b.selectedIndex];
    view.layer = /** @type {Layer} */ (this.select.layer.value);
    view.curve = this.select.curve.value;
    view.exposure = this.input.exposure.valueAsNumber;
    view.split = this.input.split.valueAsNumber;
    view.isSplit = this.input.isSplit.checked;
    this.show();
  }

  /** Shows the view as it is. */
  show() {
    const view = this.view;
    draw(view, this.canvas);
    const stops = view.exposure > 0 ? `+${view.exposure}` : String(view.exposure).replace("-", "−");
    byId("exposure-value", HTMLOutputElement).value = `${stops} EV`;
    byId("split-value", HTMLOutputElement).value = `${Math.round(100 * view.split)} %`;
    byId("zoom", HTMLOutputElement).value = view.zoom < 1 ? `1/${1 / view.zoom}×` : `${view.zoom}×`;
    this.input.split.disabled = !view.isSplit;
    this.flipButton.setAttribute("aria-pressed", String(view.side === "b"));
    const sides = view.isSplit ? /** @type {const} */ (["a", "b"]) : [view.side];
    const words = sides.map((side) => `${side.toUpperCase()}: ${this.described(view[side])}`).join("   |   ");
    byId("shown", HTMLOutputElement).value = words;
    this.canvas.setAttribute("aria-label", words);
    this.showScale();
    this.showValues();
  }

  /**
   * The name of an image with the means of its errors.
   * @param {Picture} image
   */
  described(image) {
    const { layer, reference } = this.view;
    if (image === reference || layer === "image") return image.name;
    const errors = errorsOf(layer, image, reference);
    return errors ? `${image.name}, mean ${written(meanOf(errors))}` : `${image.name}, not known`;
  }

  /** Shows which colours mean which errors. */
  showScale() {
    const { layer } = this.view;
    byId("scale", HTMLElement).hidden = layer === "image";
    if (layer === "image") return;
    const [low, high] = layer === "flip" ? [0, 1] : RELATIVE_RANGE;
    byId("scale-low", HTMLOutputElement).value = layer === "flip" ? "0" : `≤ ${low}`;
    byId("scale-high", HTMLOutputElement).value = layer === "flip" ? "1" : `≥ ${high} (logarithmic)`;
    const errors = Float32Array.from({ length: 256 }, (_, i) =>
      layer === "flip" ? i / 255 : low * (high / low) ** (i / 255),
    );
    const target = new ImageData(256, 1);
    paintErrors(layer, errors, target);
    contextOf(byId("scale-bar", HTMLCanvasElement)).putImageData(target, 0, 0);
  }

  /** Shows the numbers of the pixel under the pointer. */
  showValues() {
    const { a, b, reference } = this.view;
    const place = this.pixel ? `pixel (${this.pixel.join(", ")})` : "pixel: point at the image";
    const line = (/** @type {string} */ word, /** @type {Picture | undefined} */ image) => {
      if (!this.pixel || !image) return "";
      const [column, row] = this.pixel;
      if (column >= image.width || row >= image.height) return `${word} has no such pixel`;
      const channels = image.at(row * image.width + column).map((channel) => written(channel).padStart(10));
      return `${word.padEnd(10)}${channels.join("")}`;
    };
    const lines = [place, line("A", a), line("B", b), line("reference", reference)];
    byId("values", HTMLPreElement).textContent = lines.join("\n");
  }

  /** Shows the other image. */
  flip() {
    this.view.side = this.view.side === "a" ? "b" : "a";
    this.input.isSplit.checked = false;
    this.update();
  }

  /**
   * Larger or smaller by so many steps, around a place of the canvas.
   * @param {number} steps
   */
  zoom(steps) {
    this.view.zoom = zoomed(this.view.zoom, steps);
    this.show();
  }

  /**
   * Moves the picture by CSS pixels.
   * @param {number} x
   * @param {number} y
   */
  move(x, y) {
    this.view.x -= x / this.view.zoom;
    this.view.y -= y / this.view.zoom;
    this.show();
  }

  /** Connects everything that can be used with what it does. */
  listen() {
    this.select.scene.addEventListener("change", () => {
      this.view = this.openScene();
      fit(this.view, this.canvas);
      this.update();
    });
    const { a, b, layer, curve } = this.select;
    const controls = [a, b, layer, curve, ...Object.values(this.input)];
    for (const control of controls) control.addEventListener("input", () => this.update());
    this.flipButton.addEventListener("click", () => this.flip());
    byId("zoom-in", HTMLButtonElement).addEventListener("click", () => this.zoom(1));
    byId("zoom-out", HTMLButtonElement).addEventListener("click", () => this.zoom(-1));
    byId("reset", HTMLButtonElement).addEventListener("click", () => this.reset());
    this.canvas.addEventListener("keydown", (event) => this.press(event));
    this.listenToPointer();
    new ResizeObserver(() => this.show()).observe(this.canvas);
  }

  /** The pointer tells a pixel, drags the picture, and its wheel zooms. */
  listenToPointer() {
    const canvas = this.canvas;
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) this.move(event.movementX, event.movementY);
      this.pixel = pixelAt(this.view, canvas, event.offsetX, event.offsetY);
      this.showValues();
    });
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    // Without Ctrl the wheel scrolls the page, as everywhere else.
    const wheel = (/** @type {WheelEvent} */ event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.zoom(event.deltaY < 0 ? 1 : -1);
    };
    canvas.addEventListener("wheel", wheel, { passive: false });
  }

  /**
   * Does what a key means.
   * @param {KeyboardEvent} event
   */
  press(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const action = this.actions()[event.key.toLowerCase()] ?? this.chooser(event.key);
    if (!action) return;
    event.preventDefault();
    action();
  }

  /**
   * What keys do.
   * @returns {Record<string, () => void>}
   */
  actions() {
    const expose = (/** @type {number} */ stops) => {
      this.input.exposure.valueAsNumber += stops;
      this.update();
    };
    const split = () => {
      this.input.isSplit.checked = !this.input.isSplit.checked;
      this.update();
    };
    const nextLayer = () => {
      const { layer } = this.select;
      layer.selectedIndex = (layer.selectedIndex + 1) % layer.length;
      this.update();
    };
    return {
      f: () => this.flip(),
      " ": () => this.flip(),
      s: split,
      e: nextLayer,
      r: () => this.reset(),
      "[": () => expose(-0.5),
      "]": () => expose(0.5),
      "+": () => this.zoom(1),
      "=": () => this.zoom(1),
      "-": () => this.zoom(-1),
      arrowleft: () => this.move(32, 0),
      arrowright: () => this.move(-32, 0),
      arrowup: () => this.move(0, 32),
      arrowdown: () => this.move(0, -32),
    };
  }

  /**
   * A digit puts an image in place of the one that is shown.
   * @param {string} key
   */
  chooser(key) {
    const index = "123456789".indexOf(key);
    if (index < 0 || index >= this.images.length) return null;
    return () => {
      this.select[this.view.side].selectedIndex = index;
      this.update();
    };
  }
}

/** @type {StoredScene[]} */
const scenes = JSON.parse(byId("images", HTMLScriptElement).text);
const viewer = scenes.length > 0 ? new Viewer(scenes) : null;
