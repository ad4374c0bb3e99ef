// What hands do on the stage: mouse, fingers, wheel and keys.

import { box } from "./dom.js";
import { walks } from "./motion.js";

/** @import { Pilot } from "./motion.js" */
/** @import { Stage } from "./stage.js" */
/** @import { Point } from "./view.js" */

/** @typedef {"look" | "move" | "sample"} Mode */

/**
 * What the page does with it.
 * @typedef {object} Hands
 * @property {() => Mode} mode
 * @property {(pixel: Point) => void} onClick
 * @property {(pixel: Point | null) => void} onHover
 * @property {() => void} onEnter
 * @property {() => void} onHome
 */

/** Radians for a CSS pixel. */
const TURN = 0.006;
/** Radians for an arrow key. */
const KEY_TURN = 0.08;
/** How far a hand may shake in a click. Unit: CSS pixels. */
const SHAKE = 4;

/** @type {Map<string, Point>} */
const ARROWS = new Map([
  ["ArrowLeft", [-1, 0]],
  ["ArrowRight", [1, 0]],
  ["ArrowUp", [0, -1]],
  ["ArrowDown", [0, 1]],
]);

export class Gestures {
  /**
   * @param {Stage} stage
   * @param {Pilot} pilot
   * @param {Hands} hands
   */
  constructor(stage, pilot, hands) {
    this.stage = stage;
    this.pilot = pilot;
    this.hands = hands;
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
    element.addEventListener("pointerleave", () => this.hands.onHover(null));
    element.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    element.addEventListener("keydown", (event) => this.key(event));
    element.addEventListener("keyup", (event) => this.pilot.release(event.code));
    element.addEventListener("blur", () => this.pilot.held.clear());
  }

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
    if (!last) return this.hands.onHover(this.stage.at(place));
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
   * @param {boolean} shift
   */
  drag(by, shift) {
    if (this.hands.mode() !== "move") return this.stage.pan(by);
    if (shift) return this.shift(by);
    this.pilot.move("orbit", { yaw: -TURN * by[0], pitch: TURN * by[1] });
  }

  /**
   * Shifts the camera, so that what is under the hand follows it, about.
   * @param {Point} by
   */
  shift(by) {
    const scale = 1 / Math.max(1, this.stage.view.zoom * this.stage.film[1]);
    this.pilot.move("pan", { right: -scale * by[0], up: scale * by[1] });
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
    const factor = apart(place) / apart(last);
    // Each finger moves the middle by half of its own way.
    const half = /** @type {Point} */ ([by[0] / 2, by[1] / 2]);
    if (this.hands.mode() === "move") {
      this.pilot.move("dolly", { factor: 1 / factor });
      this.shift(half);
    } else {
      this.stage.zoom(factor, [(place[0] + other[0]) / 2, (place[1] + other[1]) / 2]);
      this.stage.pan(half);
    }
  }

  /** @param {PointerEvent} event */
  up(event) {
    const isClick = this.pointers.size === 1 && this.travelled <= SHAKE;
    const was = this.pointers.has(event.pointerId);
    this.forget(event);
    const pixel = this.stage.at(this.place(event));
    if (was && isClick && pixel) this.hands.onClick(pixel);
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
    const factor = Math.exp(-turn * (event.ctrlKey ? 0.01 : 0.0025));
    if (this.hands.mode() === "move") return this.pilot.move("dolly", { factor: 1 / factor });
    this.stage.zoom(factor, this.place(event));
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.target !== this.stage.element || event.ctrlKey || event.metaKey || event.altKey) return;
    const isMoving = this.hands.mode() === "move";
    const arrow = ARROWS.get(event.key);
    let isKnown = true;
    if (arrow && event.shiftKey && !isMoving) this.step(arrow);
    else if (arrow) this.arrow(arrow, isMoving, event.shiftKey);
    else if (isMoving && walks(event.code)) this.pilot.press(event.code);
    else isKnown = this.letter(event.key, isMoving);
    if (isKnown) event.preventDefault();
  }

  /**
   * To the next pixel.
   * @param {Point} arrow
   */
  step(arrow) {
    const { crop, pixel } = this.stage;
    const from = pixel ?? [(crop[0] + crop[2]) >> 1, (crop[1] + crop[3]) >> 1];
    this.hands.onClick([from[0] + arrow[0], from[1] + arrow[1]]);
  }

  /**
   * @param {Point} arrow
   * @param {boolean} isMoving
   * @param {boolean} shift
   */
  arrow(arrow, isMoving, shift) {
    if (!isMoving) return this.stage.pan([-48 * arrow[0], -48 * arrow[1]]);
    if (shift) return this.shift([-24 * arrow[0], -24 * arrow[1]]);
    this.pilot.move("orbit", { yaw: KEY_TURN * arrow[0], pitch: -KEY_TURN * arrow[1] });
  }

  /**
   * Whether the key means something.
   * @param {string} key
   * @param {boolean} isMoving
   */
  letter(key, isMoving) {
    const zoom = (/** @type {number} */ factor) =>
      isMoving ? this.pilot.move("dolly", { factor: 1 / factor }) : this.stage.zoom(factor);
    /** @type {Map<string, () => void>} */
    const actions = new Map([
      ["+", () => zoom(1.19)],
      ["=", () => zoom(1.19)],
      ["-", () => zoom(1 / 1.19)],
      ["0", () => this.stage.fit()],
      ["1", () => this.stage.oneToOne()],
      ["[", () => this.stage.expose(-0.5)],
      ["]", () => this.stage.expose(0.5)],
      ["Enter", () => this.hands.onEnter()],
    ]);
    if (isMoving) actions.set("h", () => this.hands.onHome());
    const action = actions.get(key);
    action?.();
    return action !== undefined;
  }
}
