// Hands that also steer the camera, where the mode is to move it.

import { Gestures } from "./gestures.js";
import { walks } from "./motion.js";

/** @import { Pilot } from "./motion.js" */
/** @import { Stage } from "./stage.js" */
/** @import { Point } from "./view.js" */

/** @typedef {"look" | "move" | "sample"} Mode */

/**
 * The actions of the page.
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

export class Steering extends Gestures {
  /**
   * @param {Stage} stage
   * @param {Pilot} pilot
   * @param {Hands} hands
   */
  constructor(stage, pilot, hands) {
    super(stage);
    this.pilot = pilot;
    this.hands = hands;
    stage.element.addEventListener("keyup", (event) => pilot.release(event.code));
    stage.element.addEventListener("blur", () => pilot.held.clear());
  }

  get isMoving() {
    return this.hands.mode() === "move";
  }

  /** @param {Point | null} pixel */
  onHover(pixel) {
    this.hands.onHover(pixel);
  }

  /** @param {Point} pixel */
  onClick(pixel) {
    this.hands.onClick(pixel);
  }

  /**
   * @param {Point} by
   * @param {boolean} shift
   */
  drag(by, shift) {
    if (!this.isMoving) return super.drag(by, shift);
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
   * @param {number} factor
   * @param {Point} [about]
   */
  spread(factor, about) {
    if (this.isMoving) this.pilot.move("dolly", { factor: 1 / factor });
    else super.spread(factor, about);
  }

  /** @param {Point} by */
  follow(by) {
    if (this.isMoving) this.shift(by);
    else super.follow(by);
  }

  /**
   * @param {Point} arrow
   * @param {boolean} shift
   */
  arrow(arrow, shift) {
    if (!this.isMoving) return super.arrow(arrow, shift);
    if (shift) return this.shift([-24 * arrow[0], -24 * arrow[1]]);
    this.pilot.move("orbit", { yaw: KEY_TURN * arrow[0], pitch: -KEY_TURN * arrow[1] });
  }

  /** @param {KeyboardEvent} event */
  letter(event) {
    if (!this.isMoving || !walks(event.code)) return super.letter(event);
    this.pilot.press(event.code);
    return true;
  }

  actions() {
    const actions = super.actions().set("Enter", () => this.hands.onEnter());
    return this.isMoving ? actions.set("h", () => this.hands.onHome()) : actions;
  }
}
