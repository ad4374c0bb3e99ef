// Commands that move the camera: what hands do within a moment becomes one command, so that no more
// are sent than the server can follow.

/** @typedef {"orbit" | "pan" | "dolly" | "walk"} MotionName */

/** @typedef {{[name: string]: number}} Amounts */

/** The time between two commands. Unit: milliseconds. */
export const INTERVAL = 1000 / 15;

/** The motion that waits to be sent: a sum for each kind, for dolly a product. */
export class Motions {
  constructor() {
    /** @type {Map<MotionName, Amounts>} */
    this.waiting = new Map();
  }

  /**
   * @param {MotionName} name
   * @param {Amounts} amounts
   */
  add(name, amounts) {
    const sum = this.waiting.get(name) ?? {};
    for (const [key, amount] of Object.entries(amounts)) {
      sum[key] = key === "factor" ? (sum[key] ?? 1) * amount : (sum[key] ?? 0) + amount;
    }
    this.waiting.set(name, sum);
  }

  /**
   * Takes the kind that has waited longest.
   * @returns {[MotionName, Amounts] | null}
   */
  next() {
    const [first] = this.waiting;
    if (!first) return null;
    this.waiting.delete(first[0]);
    return first;
  }
}

/** The way that a key walks in a second, in distances to the target. */
const SPEED = 0.6;

/** Keys that walk: forward, right, up. */
const WALKS = new Map([
  ["KeyW", [1, 0, 0]],
  ["KeyS", [-1, 0, 0]],
  ["KeyD", [0, 1, 0]],
  ["KeyA", [0, -1, 0]],
  ["KeyE", [0, 0, 1]],
  ["KeyQ", [0, 0, -1]],
]);

/** @param {string} code */
export function walks(code) {
  return WALKS.has(code);
}

/**
 * The way that the held keys walk in some time; null: they keep each other in place.
 * @param {Iterable<string>} codes
 * @param {number} seconds
 * @returns {Amounts | null}
 */
export function walk(codes, seconds) {
  const sum = [0, 0, 0];
  for (const code of codes) WALKS.get(code)?.forEach((amount, axis) => (sum[axis] += amount));
  if (sum.every((amount) => amount === 0)) return null;
  const [forward, right, up] = sum.map((amount) => amount * SPEED * seconds);
  return { forward, right, up, yaw: 0, pitch: 0 };
}

/** Sends motions, one at each interval. */
export class Pilot {
  /** @param {(name: MotionName, amounts: Amounts) => void} send */
  constructor(send) {
    this.send = send;
    this.motions = new Motions();
    /** @type {Set<string>} */
    this.held = new Set();
    /** @type {ReturnType<typeof setInterval> | null} */
    this.timer = null;
  }

  /**
   * @param {MotionName} name
   * @param {Amounts} amounts
   */
  move(name, amounts) {
    this.motions.add(name, amounts);
    this.start();
  }

  /** @param {string} code */
  press(code) {
    this.held.add(code);
    this.start();
  }

  /** @param {string} code */
  release(code) {
    this.held.delete(code);
  }

  /** Sends nothing of what waits: it was meant from where the camera is no more. */
  forget() {
    this.motions.waiting.clear();
  }

  start() {
    if (this.timer !== null) return;
    this.tick();
    this.timer = setInterval(() => this.tick(), INTERVAL);
  }

  tick() {
    const step = walk(this.held, INTERVAL / 1000);
    if (step) this.motions.add("walk", step);
    const next = this.motions.next();
    if (next) return this.send(...next);
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = null;
  }
}
