// The page: connects its parts with each other and with the server.

import { showCurves } from "./chart.js";
import { connectDivider, placeDivider } from "./divider.js";
import { box, button, get, say } from "./dom.js";
import { cell, digits } from "./format.js";
import { connectTransport, showFigures, showHead } from "./head.js";
import { Inspector } from "./inspector.js";
import { Link } from "./link.js";
import { connectMethods, showMethods } from "./methods.js";
import { Pilot } from "./motion.js";
import { valueAt } from "./pixels.js";
import { placePlain, showPlain } from "./plain.js";
import { Pyramid } from "./pyramid.js";
import { SampleView } from "./sample.js";
import { connectSave, showSave } from "./save.js";
import { Stage } from "./stage.js";
import { Steering } from "./steering.js";
import { connectTabs, showTab } from "./tabs.js";
import { drawValues, marker } from "./values.js";

/** @import { LaneName } from "./pixels.js" */
/** @import { Mode } from "./steering.js" */
/** @import { Status } from "./types.js" */
/** @import { Point } from "./view.js" */

/** @type {Status | null} */
let status = null;
/** @type {Point | null} */
let hovered = null;

const stage = new Stage((reason) => showPlain(link, reason));
const link = new Link({ onStatus: show, onFrame: (frame) => stage.take(frame), onBreak: tellBreak });
const inspector = new Inspector(link, choose);
const sample = new SampleView(link, () => stage.redraw());
const pyramid = new Pyramid(link);
const pilot = new Pilot((name, amounts) => link.send(name, amounts));
new Steering(stage, pilot, {
  mode,
  onClick: click,
  onHover: (pixel) => {
    hovered = pixel;
    tellHovered();
  },
  onEnter: () => (mode() === "sample" ? sample.ask() : undefined),
  onHome: goHome,
});

connectTransport(link, () => status);
connectMethods(link, () => status);
connectDivider(stage);
connectSave(link, stage);
connectTabs(() => pyramid.look());
connectModes();
connectKeys();
stage.listeners.push(drawOver);
if (!stage.picture) stage.giveUp("This browser has no WebGL2");

/** @returns {Mode} */
function mode() {
  const checked = document.querySelector('input[name="mode"]:checked');
  return checked instanceof HTMLInputElement ? /** @type {Mode} */ (checked.value) : "look";
}

function connectModes() {
  box("modes").addEventListener("input", () => {
    stage.element.dataset.mode = mode();
    if (mode() === "sample") showTab("tab-sample");
  });
  button("home").addEventListener("click", goHome);
}

function goHome() {
  pilot.forget();
  link.send("home");
}

function connectKeys() {
  const keys = get("keys", HTMLDialogElement);
  box("help").addEventListener("click", () => keys.showModal());
  document.addEventListener("keydown", (event) => {
    const isTyping = event.target instanceof HTMLInputElement && event.target.type === "text";
    if (event.key === "?" && !isTyping && !document.querySelector("dialog[open]")) keys.showModal();
  });
}

/** @param {Status} told */
function show(told) {
  status = told;
  allow(told);
  showHead(told);
  showFigures(told.lanes);
  showMethods(told);
  showCurves(told.lanes);
  showSave(told);
  showCamera(told);
  stage.update(told);
  inspector.update(told);
  sample.update(told);
  pyramid.update(told);
}

/**
 * Hides what this server does not allow.
 * @param {Status} told
 */
function allow({ controls, camera }) {
  const needs = { controls, camera: controls && camera !== null };
  for (const [need, isThere] of Object.entries(needs)) {
    for (const element of document.querySelectorAll(`[data-needs="${need}"]`)) {
      if (element instanceof HTMLElement) element.hidden = !isThere;
    }
  }
  if (!needs.camera && mode() === "move") {
    get("modes", HTMLFieldSetElement).querySelector("input")?.click();
  }
}

/** @param {Status} told */
function showCamera({ camera }) {
  if (!camera) return;
  button("home").disabled = !camera.moved;
  const [origin, target] = [camera.origin, camera.target].map((point) => point.map((part) => Number(part.toFixed(4))).join(", "));
  say(box("camera-place"), `${camera.moved ? "Moved: at" : "At"} ${origin}, looking at ${target}. In Move mode, drag to orbit and walk by W A S D.`);
}

/** @param {number | null} seconds */
function tellBreak(seconds) {
  const notice = box("notice");
  notice.hidden = seconds === null;
  if (seconds === null) return;
  sample.expire();
  say(notice, `The server does not answer. The last image stays; the next try is in ${digits(seconds, 2)} s.`);
  const state = box("state");
  state.dataset.state = "away";
  say(state, "away");
}

/** @param {Point} pixel */
function click(pixel) {
  const chosen = choose(pixel);
  if (mode() === "sample") {
    showTab("tab-sample");
    sample.ask();
  } else if (mode() === "look" && window.matchMedia("(min-width: 901px)").matches) {
    showTab("tab-pixel");
  }
  return chosen;
}

/** @param {Point} pixel */
function choose(pixel) {
  const chosen = stage.choose(pixel);
  inspector.choose(chosen);
  sample.choose(chosen);
  return chosen;
}

/** Draws what lies over the picture. */
function drawOver() {
  drawValues(stage);
  placeDivider(stage);
  placePlain(stage);
  get("drawing", SVGSVGElement).replaceChildren(...sample.drawing(stage.view), ...marker(stage));
  nameLanes();
  tellHovered();
}

function nameLanes() {
  const isSplit = Boolean(stage.picture?.frame("b"));
  for (const name of /** @type {LaneName[]} */ (["a", "b"])) {
    const lane = status?.lanes.find(({ lane }) => lane === name);
    const label = box(`name-${name}`);
    label.hidden = !isSplit || !lane;
    if (lane) say(label, `${name} ${lane.integrator}, ${lane.shadowRays}`);
  }
}

/** Shows the value under the pointer, as it came with the newest frames. */
function tellHovered() {
  const pixel = hovered;
  if (!pixel) return say(box("hover"), "");
  const texts = /** @type {LaneName[]} */ (["a", "b"]).flatMap((lane) => {
    const frame = stage.picture?.frame(lane);
    const value = frame && valueAt(frame, stage.film, pixel);
    return value ? [`${lane}: ${value.map(cell).join("  ")}`] : [];
  });
  say(box("hover"), `${pixel[0]}, ${pixel[1]}   ${texts.join("   ")}`);
}
