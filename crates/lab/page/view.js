// The place of the film on the screen: screen = zoom · film + offset. Screen coordinates are CSS pixels
// from the stage's top left corner.

/** @typedef {[number, number]} Point */

/** @typedef {{zoom: number, offset: Point}} View */

/** The range of the zoom, from a film as a dot to a pixel as large as a window. */
export const ZOOM_RANGE = [1 / 64, 512];

/** From where on numbers fit into a pixel. Unit: CSS pixels of a side. */
export const VALUES_ZOOM = 56;

/**
 * @param {number} value
 * @param {number} low
 * @param {number} high
 */
export function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

/**
 * The whole film in the middle of the stage, with a margin.
 * @param {Point} film
 * @param {Point} stage
 * @returns {View}
 */
export function fit(film, stage) {
  const margin = Math.min(stage[0], stage[1]) > 400 ? 16 : 4;
  const zoom = Math.min((stage[0] - 2 * margin) / film[0], (stage[1] - 2 * margin) / film[1]);
  return centred(film, stage, clamp(zoom, ZOOM_RANGE[0], ZOOM_RANGE[1]));
}

/**
 * The film's middle in the middle of the stage.
 * @param {Point} film
 * @param {Point} stage
 * @param {number} zoom
 * @returns {View}
 */
export function centred(film, stage, zoom) {
  return { zoom, offset: [(stage[0] - zoom * film[0]) / 2, (stage[1] - zoom * film[1]) / 2] };
}

/**
 * Zooms about a point of the screen, which stays where it is on the film.
 * @param {View} view
 * @param {number} factor
 * @param {Point} about
 * @returns {View}
 */
export function zoomAt(view, factor, about) {
  const zoom = clamp(view.zoom * factor, ZOOM_RANGE[0], ZOOM_RANGE[1]);
  const [x, y] = toFilm(view, about);
  return { zoom, offset: [about[0] - zoom * x, about[1] - zoom * y] };
}

/**
 * Moves the film on the screen, of which a part always stays in sight.
 * @param {View} view
 * @param {Point} by
 * @param {Point} film
 * @param {Point} stage
 * @returns {View}
 */
export function pan(view, by, film, stage) {
  const keep = 32;
  const along = (/** @type {0 | 1} */ axis) =>
    clamp(view.offset[axis] + by[axis], keep - view.zoom * film[axis], stage[axis] - keep);
  return { zoom: view.zoom, offset: [along(0), along(1)] };
}

/**
 * @param {View} view
 * @param {Point} screen
 * @returns {Point}
 */
export function toFilm(view, screen) {
  return [(screen[0] - view.offset[0]) / view.zoom, (screen[1] - view.offset[1]) / view.zoom];
}

/**
 * @param {View} view
 * @param {Point} film
 * @returns {Point}
 */
export function toScreen(view, film) {
  return [view.zoom * film[0] + view.offset[0], view.zoom * film[1] + view.offset[1]];
}

/**
 * The pixel under a point of the screen; null outside the crop.
 * @param {View} view
 * @param {Point} screen
 * @param {[number, number, number, number]} crop
 * @returns {Point | null}
 */
export function pixelAt(view, screen, crop) {
  const [x, y] = toFilm(view, screen).map(Math.floor);
  const isInside = x >= crop[0] && y >= crop[1] && x < crop[2] && y < crop[3];
  return isInside ? [x, y] : null;
}
