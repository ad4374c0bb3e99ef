// What the canvas shows: which images, how they are painted, and where.

/** Screen pixels per pixel of the image. */
const ZOOMS = [1 / 16, 1 / 8, 1 / 4, 1 / 2, 1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32, 48, 64];

/**
 * All that decides what is seen. `x` and `y` are the place of the image in the middle of the canvas.
 * @typedef {object} View
 * @property {Picture} a
 * @property {Picture} b
 * @property {Picture | undefined} reference
 * @property {"a" | "b"} side Which is shown, where the picture is not divided.
 * @property {boolean} isSplit
 * @property {number} split The part of the image that A has, from the left.
 * @property {Layer} layer
 * @property {string} curve
 * @property {number} exposure Unit: stops.
 * @property {number} zoom
 * @property {number} x
 * @property {number} y
 */

/**
 * Painted images, so that flipping is only drawing.
 * @type {Map<string, HTMLCanvasElement>}
 */
const painted = new Map();

/**
 * A canvas of the size of an image, with a layer of it. Null: the layer is not known.
 * @param {View} view
 * @param {Picture} image
 */
function paint(view, image) {
  const light = `${view.exposure} ${view.curve}`;
  const key = JSON.stringify([image.name, view.layer, view.layer === "image" ? light : ""]);
  let canvas = painted.get(key);
  if (canvas) return canvas;
  const target = new ImageData(image.width, image.height);
  if (view.layer === "image") {
    paintLight(image, view.exposure, view.curve, target);
  } else {
    const errors = errorsOf(view.layer, image, view.reference);
    if (!errors) return null;
    paintErrors(view.layer, errors, target);
  }
  canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [image.width, image.height];
  contextOf(canvas).putImageData(target, 0, 0);
  // Moving the exposure should not fill the memory.
  if (painted.size > 24) painted.clear();
  painted.set(key, canvas);
  return canvas;
}

/**
 * The two-dimensional context, which every browser has.
 * @param {HTMLCanvasElement} canvas
 */
function contextOf(canvas) {
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (!context) throw new Error("the canvas has no context");
  return context;
}

/**
 * The place on the canvas of the top left of an image, in device pixels.
 * @param {View} view
 * @param {HTMLCanvasElement} canvas
 */
function cornerOf(view, canvas) {
  const scale = view.zoom * devicePixelRatio;
  return [canvas.width / 2 - view.x * scale, canvas.height / 2 - view.y * scale].map(Math.round);
}

/**
 * Draws what the view says.
 * @param {View} view
 * @param {HTMLCanvasElement} canvas
 */
function draw(view, canvas) {
  canvas.width = Math.round(canvas.clientWidth * devicePixelRatio);
  canvas.height = Math.round(canvas.clientHeight * devicePixelRatio);
  const context = contextOf(canvas);
  // Pixels stay squares; where many fall on one of the screen, they are averaged.
  context.imageSmoothingEnabled = view.zoom < 1;
  const edge = Math.round(view.split * view.a.width);
  if (view.isSplit) {
    drawPart(view, view.a, canvas, [0, edge]);
    drawPart(view, view.b, canvas, [edge, view.b.width]);
    drawEdge(view, canvas, edge);
  } else {
    drawPart(view, view[view.side], canvas, [0, view[view.side].width]);
  }
}

/**
 * Draws the columns of an image from the first up to the second.
 * @param {View} view
 * @param {Picture} image
 * @param {HTMLCanvasElement} canvas
 * @param {[number, number]} columns
 */
function drawPart(view, image, canvas, [from, to]) {
  const source = paint(view, image);
  const scale = view.zoom * devicePixelRatio;
  const [left, top] = cornerOf(view, canvas);
  if (!source || to <= from) return;
  const [width, height] = [to - from, image.height];
  const target = [left + from * scale, top, width * scale, height * scale];
  const [x, y, w, h] = target;
  contextOf(canvas).drawImage(source, from, 0, width, height, x, y, w, h);
}

/**
 * Draws the line between both parts: white with black beside it, to be seen on any image.
 * @param {View} view
 * @param {HTMLCanvasElement} canvas
 * @param {number} column
 */
function drawEdge(view, canvas, column) {
  const context = contextOf(canvas);
  const scale = view.zoom * devicePixelRatio;
  const [left, top] = cornerOf(view, canvas);
  const x = left + column * scale;
  context.fillStyle = "black";
  context.fillRect(x - 2, top, 4, view.a.height * scale);
  context.fillStyle = "white";
  context.fillRect(x - 1, top, 2, view.a.height * scale);
}

/**
 * The pixel of the image at a place of the canvas, in CSS pixels. Null: there is none.
 * @param {View} view
 * @param {HTMLCanvasElement} canvas
 * @param {number} x
 * @param {number} y
 * @returns {[number, number] | null}
 */
function pixelAt(view, canvas, x, y) {
  const [left, top] = cornerOf(view, canvas);
  const scale = view.zoom * devicePixelRatio;
  const column = Math.floor((x * devicePixelRatio - left) / scale);
  const row = Math.floor((y * devicePixelRatio - top) / scale);
  const isInside = column >= 0 && row >= 0 && column < view.a.width && row < view.a.height;
  return isInside ? [column, row] : null;
}

/**
 * Puts the whole image into the canvas, as large as whole multiples allow.
 * @param {View} view
 * @param {HTMLCanvasElement} canvas
 */
function fit(view, canvas) {
  const { width, height } = view.a;
  const room = Math.min(canvas.clientWidth / width, canvas.clientHeight / height);
  view.zoom = ZOOMS.filter((zoom) => zoom <= room).pop() ?? ZOOMS[0];
  [view.x, view.y] = [width / 2, height / 2];
}

/**
 * The zoom so many steps further.
 * @param {number} zoom
 * @param {number} steps
 */
function zoomed(zoom, steps) {
  const index = ZOOMS.indexOf(zoom) + steps;
  return ZOOMS[Math.min(Math.max(index, 0), ZOOMS.length - 1)];
}
