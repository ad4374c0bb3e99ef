// The head of the page: what is rendered, how far it is, and the buttons that steer it.

import { box, button, get, make, say } from "./dom.js";
import { compact, count, digits, duration, percent } from "./format.js";

/** @import { Link } from "./link.js" */
/** @import { Lane, Rays, Status } from "./types.js" */

/** Kinds of rays as people call them. */
const RAYS = /** @type {[keyof Rays, string][]} */ ([
  ["camera", "Camera rays/s"],
  ["light", "Light rays/s"],
  ["connection", "Connection rays/s"],
  ["lightImage", "Light image rays/s"],
]);

/**
 * Connects the buttons.
 * @param {Link} link
 * @param {() => Status | null} status
 */
export function connectTransport(link, status) {
  button("pause").addEventListener("click", () => {
    link.send(status()?.state === "paused" ? "resume" : "pause");
  });
  button("restart").addEventListener("click", () => link.send("restart"));
  button("stop").addEventListener("click", () => link.send("stop"));
}

/**
 * Passes done of those wanted, of the lane that has furthest to go. Null: there is no end.
 * @param {Lane[]} lanes
 */
export function share(lanes) {
  const shares = lanes.map((lane) => (lane.target ? lane.passes / lane.target : null));
  if (shares.length === 0 || shares.includes(null)) return null;
  return Math.min(...shares.map((part) => part ?? 0));
}

/** @param {Status} status */
export function showHead(status) {
  document.title = `${status.scene} – bidir`;
  say(box("scene"), status.scene);
  const state = box("state");
  state.dataset.state = status.state;
  say(state, status.state);
  const progress = get("progress", HTMLProgressElement);
  const done = share(status.lanes);
  if (done === null) progress.removeAttribute("value");
  else progress.value = done;
  progress.hidden = done === null;
  say(box("brief"), brief(status));
  button("pause").disabled = !["rendering", "paused"].includes(status.state);
  say(button("pause"), status.state === "paused" ? "Resume" : "Pause");
  button("stop").disabled = !["rendering", "paused"].includes(status.state);
  say(box("message"), status.message ?? "");
}

/** @param {Status} status */
function brief({ lanes, state }) {
  const [lane] = lanes;
  if (!lane) return "";
  const passes = lane.target ? `${lane.passes} of ${count(lane.target, "pass")}` : count(lane.passes, "pass");
  const eta = state === "rendering" && lane.eta !== null ? `, ${duration(lane.eta)} left` : "";
  return `${passes}${eta}`;
}

/**
 * The rows of the table of figures: a name, and a text for each lane.
 * @param {Lane[]} lanes
 * @returns {[string, string[]][]}
 */
export function figures(lanes) {
  const row = (/** @type {string} */ name, /** @type {(lane: Lane) => string} */ text) =>
    /** @type {[string, string[]]} */ ([name, lanes.map(text)]);
  return [
    row("Passes", (lane) => `${lane.passes}${lane.target ? ` of ${lane.target}` : ""}`),
    row("Time", (lane) => duration(lane.seconds)),
    row("Left", (lane) => duration(lane.eta)),
    row("Relative error", (lane) => percent(lane.relativeError)),
    row("Samples/s", (lane) => compact(lane.samplesPerSecond)),
    ...RAYS.map(([kind, name]) => row(name, (lane) => compact(lane.raysPerSecond[kind]))),
    row("Connection rays/sample", (lane) => digits(lane.raysPerSample.connection, 3)),
  ];
}

/** @param {Lane[]} lanes */
export function showFigures(lanes) {
  const table = get("figures", HTMLTableElement);
  const rows = figures(lanes);
  if (table.rows.length !== rows.length + 1 || table.rows[0].cells.length !== lanes.length + 1) {
    buildTable(table, rows, lanes);
  }
  lanes.forEach((lane, column) => {
    const method = lane.preview ? `${lane.integrator}, preview` : lane.integrator;
    say(table.rows[0].cells[column + 1].lastElementChild ?? table, method);
    rows.forEach(([, texts], i) => say(table.rows[i + 1].cells[column + 1], texts[column]));
  });
}

/**
 * @param {HTMLTableElement} table
 * @param {[string, string[]][]} rows
 * @param {Lane[]} lanes
 */
function buildTable(table, rows, lanes) {
  const heads = lanes.map(({ lane }) =>
    make("th", { scope: "col" }, [make("span", { class: `badge ${lane}` }, [lane]), " ", make("span")]),
  );
  const body = rows.map(([name, texts]) =>
    make("tr", {}, [make("th", { scope: "row" }, [name]), ...texts.map(() => make("td"))]),
  );
  table.replaceChildren(
    make("caption", { class: "unseen" }, ["Progress and speed"]),
    make("thead", {}, [make("tr", {}, [make("th", {}, ["Lane"]), ...heads])]),
    make("tbody", {}, body),
  );
}
