// Gestures on the stage, by mouse, fingers, wheel and keys, that move its view.

import { box } from "./dom.js";

/** @import { Stage } from "./stage.js" */
/** @import { Point } from "./view.js" */

/** The longest way of the pointer in a click. Unit: CSS pixels. */
const SHAKE = 4;

/** @type {Map<string, Point>} */
const ARROWS = new Map([
  ["ArrowLeft", [-1, 0]],
  ["ArrowRight", [1, 0]],
  ["ArrowUp", [0, -1]],
  ["ArrowDown", [0, 1]],
]);

export class Gestures {
  /** @param {Stage} stage */
  constructor(stage) {
    this.stage = stage;
    /** @type {Map<number, Point>} */
    this.pointers = new Map();
    this.travelled = 0;
    this.connect(stage.element);
  }

  /** @param {HTMLElement} element */
  connect(element) {
    element.addEventListener("pointerdown", (event) => this.down(event));
    element.addEventListener("pointermove", (event) => this.move(event));
    element.addEventListener("pointerup", (event) => this.up(event));
    element.addEventListener("pointercancel", (event) => this.forget(event));
    element.addEventListener("pointerleave", () => this.onHover(null));
    element.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    element.addEventListener("keydown", (event) => this.key(event));
  }

  /** @param {Point | null} _pixel Under the pointer. */
  onHover(_pixel) {}

  /** @param {Point} _pixel */
  onClick(_pixel) {}

  /**
   * @param {MouseEvent} event
   * @returns {Point}
   */
  place(event) {
    const { left, top } = this.stage.element.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  /** @param {PointerEvent} event */
  down(event) {
    if (event.target === box("divider") || event.button > 1) return;
    this.stage.element.setPointerCapture(event.pointerId);
    if (this.pointers.size === 0) this.travelled = 0;
    this.pointers.set(event.pointerId, this.place(event));
    this.stage.element.classList.add("dragging");
  }

  /** @param {PointerEvent} event */
  move(event) {
    const place = this.place(event);
    const last = this.pointers.get(event.pointerId);
    if (!last) return this.onHover(this.stage.at(place));
    const by = /** @type {Point} */ ([place[0] - last[0], place[1] - last[1]]);
    this.travelled += Math.hypot(...by);
    if (this.pointers.size === 2) {
      this.pinch(event.pointerId, place, by);
    } else if (this.travelled > SHAKE) {
      this.drag(by, event.shiftKey);
    }
    this.pointers.set(event.pointerId, place);
  }

  /**
   * @param {Point} by
   * @param {boolean} _shift
   */
  drag(by, _shift) {
    this.stage.pan(by);
  }

  /**
   * One of two fingers moves.
   * @param {number} id
   * @param {Point} place
   * @param {Point} by
   */
  pinch(id, place, by) {
    const last = /** @type {Point} */ (this.pointers.get(id));
    const [other] = [...this.pointers].filter(([pointer]) => pointer !== id).map(([, at]) => at);
    const apart = (/** @type {Point} */ at) => Math.max(8, Math.hypot(at[0] - other[0], at[1] - other[1]));
    this.spread(apart(place) / apart(last), [(place[0] + other[0]) / 2, (place[1] + other[1]) / 2]);
    // Each finger moves the middle by half of its own way.
    this.follow([by[0] / 2, by[1] / 2]);
  }

  /**
   * Two fingers or a wheel zoom about a point of the stage.
   * @param {number} factor
   * @param {Point} [about] Without it the middle.
   */
  spread(factor, about) {
    this.stage.zoom(factor, about);
  }

  /**
   * Both fingers move.
   * @param {Point} by
   */
  follow(by) {
    this.stage.pan(by);
  }

  /** @param {PointerEvent} event */
  up(event) {
    const isClick = this.pointers.size === 1 && this.travelled <= SHAKE;
    const was = this.pointers.has(event.pointerId);
    this.forget(event);
    const pixel = this.stage.at(this.place(event));
    if (was && isClick && pixel) this.onClick(pixel);
  }

  /** @param {PointerEvent} event */
  forget(event) {
    this.pointers.delete(event.pointerId);
    if (this.pointers.size === 0) this.stage.element.classList.remove("dragging");
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 33 : 1;
    const turn = Math.max(-240, Math.min(240, event.deltaY * lines));
    // Pinching on a touchpad comes as a wheel with the control key, in smaller steps.
    this.spread(Math.exp(-turn * (event.ctrlKey ? 0.01 : 0.0025)), this.place(event));
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.target !== this.stage.element || event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = ARROWS.get(event.key);
    if (arrow) this.arrow(arrow, event.shiftKey);
    else if (!this.letter(event)) return;
    event.preventDefault();
  }

  /**
   * @param {Point} arrow
   * @param {boolean} shift
   */
  arrow(arrow, shift) {
    if (shift) this.step(arrow);
    else this.stage.pan([-48 * arrow[0], -48 * arrow[1]]);
  }

  /**
   * To the next pixel.
   * @param {Point} arrow
   */
  step(arrow) {
    const { crop, pixel } = this.stage;
    const from = pixel ?? [(crop[0] + crop[2]) >> 1, (crop[1] + crop[3]) >> 1];
    this.onClick([from[0] + arrow[0], from[1] + arrow[1]]);
  }

  /**
   * True if the key has an action.
   * @param {KeyboardEvent} event
   */
  letter({ key }) {
    const action = this.actions().get(key.length === 1 ? key.toLowerCase() : key);
    action?.();
    return action !== undefined;
  }

  /**
   * The actions of keys.
   * @returns {Map<string, () => void>}
   */
  actions() {
    return new Map([
      ["+", () => this.spread(1.19)],
      ["=", () => this.spread(1.19)],
      ["-", () => this.spread(1 / 1.19)],
      ["0", () => this.stage.fit()],
      ["1", () => this.stage.oneToOne()],
      ["[", () => this.stage.expose(-0.5)],
      ["]", () => this.stage.expose(0.5)],
    ]);
  }
}
