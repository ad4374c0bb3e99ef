// Without WebGL2: the server's own PNG, asked for again and again.

import { box, get } from "./dom.js";

/** @import { Link } from "./link.js" */

/** Unit: milliseconds. */
const PERIOD = 2000;

/** @param {Link} link */
export function showPlain(link) {
  const image = get("plain", HTMLImageElement);
  image.hidden = false;
  for (const id of ["exposure", "operator", "png-shown", "zoom-in", "zoom-out", "zoom-fit", "zoom-one"]) {
    box(id).setAttribute("disabled", "");
  }
  box("plain-note").hidden = false;
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
