// Saving: what the server sends as files, and the picture as it is shown.

import { box, button, get, input } from "./dom.js";

/** @import { Link } from "./link.js" */
/** @import { Stage } from "./stage.js" */
/** @import { Status } from "./types.js" */

/**
 * Connects links and buttons.
 * @param {Link} link
 * @param {Stage} stage
 */
export function connectSave(link, stage) {
  const aim = (/** @type {string} */ id, /** @type {string} */ url) => (get(id, HTMLAnchorElement).href = url);
  aim("exr-a", link.url("/render.exr", { lane: "a" }));
  aim("exr-b", link.url("/render.exr", { lane: "b" }));
  aim("png-a", link.url("/render.png", { lane: "a" }));
  aim("log", link.url("/log"));
  button("png-shown").addEventListener("click", () => saveShown(stage));
  get("save-there", HTMLFormElement).addEventListener("submit", (event) => {
    event.preventDefault();
    link.send("save", { name: input("save-name").value });
  });
}

/** @param {Status} status */
export function showSave({ split }) {
  box("exr-b").hidden = !split;
}

/** @param {Stage} stage */
async function saveShown(stage) {
  const blob = await stage.shot();
  if (!blob) return;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = `${document.title.split(" – ")[0]}-shown.png`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
