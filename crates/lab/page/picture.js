// The picture: frames of both lanes as textures of floats, drawn by WebGL2.

import { FRAGMENT, VERTEX } from "./shaders.js";

/** @import { Frame, LaneName } from "./pixels.js" */
/** @import { View } from "./view.js" */

/** Operators by the names of `bidir tonemap`, false colour, light as it is, and errors in [0, 1]. */
export const OPERATORS = ["srgb", "agx", "neutral", "false", "linear", "errors"];

/**
 * The mapping of light to colours.
 * @typedef {{exposure: number, operator: string}} Look
 */

/** @typedef {{texture: WebGLTexture, frame: Frame}} Slot */

export class Picture {
  /**
   * Null where there is no WebGL2.
   * @param {HTMLCanvasElement} canvas
   */
  static on(canvas) {
    const gl = canvas.getContext("webgl2", { alpha: true, antialias: false, premultipliedAlpha: true });
    return gl ? new Picture(canvas, gl) : null;
  }

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {WebGL2RenderingContext} gl
   */
  constructor(canvas, gl) {
    this.canvas = canvas;
    this.gl = gl;
    /** @type {Map<LaneName, Slot>} */
    this.slots = new Map();
    this.prepare();
  }

  /** Compiles the program: at first, and when the graphics card was lost and has come back. */
  prepare() {
    this.program = link(this.gl);
    this.gl.useProgram(this.program);
    const frames = [...this.slots.values()].map((slot) => slot.frame);
    this.slots.clear();
    for (const frame of frames) this.take(frame);
  }

  /** The most pixels from side to side that a frame may have. */
  get largest() {
    return /** @type {number} */ (this.gl.getParameter(this.gl.MAX_TEXTURE_SIZE));
  }

  /**
   * Takes a frame in place of its lane's last.
   * @param {Frame} frame
   */
  take(frame) {
    const { gl } = this;
    const texture = this.slots.get(frame.lane)?.texture ?? newTexture(gl);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    const [width, height] = frame.size;
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB32F, width, height, 0, gl.RGB, gl.FLOAT, frame.channels);
    this.slots.set(frame.lane, { texture, frame });
  }

  /** @param {LaneName} lane */
  drop(lane) {
    const slot = this.slots.get(lane);
    if (slot) this.gl.deleteTexture(slot.texture);
    this.slots.delete(lane);
  }

  /**
   * The newest frame of a lane.
   * @param {LaneName} lane
   */
  frame(lane) {
    return this.slots.get(lane)?.frame ?? null;
  }

  /**
   * Draws all that is to be seen.
   * @param {View} view In CSS pixels.
   * @param {Look} look
   * @param {[number, number]} film
   * @param {number} divide Where lane b begins. Unit: CSS pixels.
   * @param {number} density Device pixels for one of CSS.
   */
  draw(view, look, film, divide, density) {
    const { gl, canvas, slots } = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    const a = slots.get("a");
    if (!a) return;
    this.setLane("A", 0, a, film);
    this.setLane("B", 1, slots.get("b") ?? a, film);
    gl.uniform2f(this.at("offset"), view.offset[0] * density, view.offset[1] * density);
    gl.uniform1f(this.at("zoom"), view.zoom * density);
    gl.uniform1f(this.at("height"), canvas.height);
    gl.uniform1f(this.at("divide"), slots.has("b") ? divide * density : canvas.width);
    gl.uniform1f(this.at("gain"), 2 ** look.exposure);
    gl.uniform1i(this.at("operator"), Math.max(0, OPERATORS.indexOf(look.operator)));
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  /**
   * @param {"A" | "B"} name
   * @param {number} unit
   * @param {Slot} slot
   * @param {[number, number]} film
   */
  setLane(name, unit, { texture, frame }, film) {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.uniform1i(this.at(`lane${name}`), unit);
    gl.uniform4f(this.at(`crop${name}`), ...frame.origin, ...frame.size);
    const [width, height] = frame.resolution;
    gl.uniform2f(this.at(`scale${name}`), width / film[0], height / film[1]);
  }

  /** @param {string} name */
  at(name) {
    return this.gl.getUniformLocation(/** @type {WebGLProgram} */ (this.program), name);
  }
}

/** @param {WebGL2RenderingContext} gl */
function newTexture(gl) {
  const texture = /** @type {WebGLTexture} */ (gl.createTexture());
  gl.bindTexture(gl.TEXTURE_2D, texture);
  // Floats of 32 bits have no other filter without an extension, and none is needed.
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  }
  return texture;
}

/** @param {WebGL2RenderingContext} gl */
function link(gl) {
  const program = /** @type {WebGLProgram} */ (gl.createProgram());
  for (const [kind, source] of /** @type {[number, string][]} */ ([
    [gl.VERTEX_SHADER, VERTEX],
    [gl.FRAGMENT_SHADER, FRAGMENT],
  ])) {
    const shader = /** @type {WebGLShader} */ (gl.createShader(kind));
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    const logs = gl.getAttachedShaders(program)?.map((shader) => gl.getShaderInfoLog(shader));
    throw new Error(`the program of the graphics card does not compile: ${logs?.join(" ")}`);
  }
  return program;
}
