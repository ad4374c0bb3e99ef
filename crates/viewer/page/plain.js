// Without WebGL2, or where it cannot hold the film: the server's own PNG, asked for again and again.

import { box, get, say } from "./dom.js";
import { toScreen } from "./view.js";

/** @import { Link } from "./link.js" */
/** @import { Stage } from "./stage.js" */

/** Unit: milliseconds. */
const PERIOD = 2000;

/**
 * @param {Link} link
 * @param {string} reason
 */
export function showPlain(link, reason) {
  const image = get("plain", HTMLImageElement);
  image.hidden = false;
  for (const id of ["exposure", "operator", "png-shown"]) box(id).setAttribute("disabled", "");
  const note = box("plain-note");
  note.hidden = false;
  say(note, `${reason}: showing the server’s PNG of a, without exposure and values.`);
  let version = 0;
  const look = () => {
    version += 1;
    image.src = link.url("/render.png", { lane: "a", version });
  };
  const again = () => setTimeout(look, PERIOD);
  image.addEventListener("load", again);
  image.addEventListener("error", again);
  look();
}

/**
 * Puts the image where the film is on the screen.
 * @param {Stage} stage
 */
export function placePlain({ picture, view, crop }) {
  if (picture) return;
  const { style } = get("plain", HTMLImageElement);
  const [left, top] = toScreen(view, [crop[0], crop[1]]);
  const [right, bottom] = toScreen(view, [crop[2], crop[3]]);
  Object.assign(style, { left: `${left}px`, top: `${top}px`, width: `${right - left}px`, height: `${bottom - top}px` });
}
