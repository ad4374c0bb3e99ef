// Which method each lane uses, and whether two are compared.

import { box, button, choose, get, say, select } from "./dom.js";

/** @import { Link } from "./link.js" */
/** @import { LaneName, Status } from "./types.js" */

/** @typedef {{integrator: string, shadowRays: string}} Method */

/** @param {LaneName} lane @returns {Method} */
function chosen(lane) {
  return { integrator: select(`integrator-${lane}`).value, shadowRays: select(`shadow-${lane}`).value };
}

/**
 * Connects the forms.
 * @param {Link} link
 * @param {() => Status | null} status
 */
export function connectMethods(link, status) {
  for (const lane of /** @type {LaneName[]} */ (["a", "b"])) {
    get(`method-${lane}`, HTMLFormElement).addEventListener("submit", (event) => {
      event.preventDefault();
      const isSplit = status()?.split;
      if (lane === "a" || isSplit) link.send("method", { lane, ...chosen(lane) });
      else link.send("split", { on: true, ...chosen(lane) });
    });
    for (const list of ["integrator", "shadow"]) {
      select(`${list}-${lane}`).addEventListener("input", () => enable(status()));
    }
  }
  button("unsplit").addEventListener("click", () => link.send("split", { on: false }));
}

/**
 * A restart is offered where it would change something.
 * @param {Status | null} status
 */
function enable(status) {
  for (const name of /** @type {LaneName[]} */ (["a", "b"])) {
    const lane = status?.lanes.find(({ lane }) => lane === name);
    const { integrator, shadowRays } = chosen(name);
    const isOther = !lane || lane.integrator !== integrator || lane.shadowRays !== shadowRays;
    button(`begin-${name}`).disabled = !isOther;
  }
}

/** @param {Status} status */
export function showMethods(status) {
  const [first] = status.lanes;
  if (!first) return;
  for (const name of /** @type {LaneName[]} */ (["a", "b"])) {
    const lane = status.lanes.find(({ lane }) => lane === name);
    const other = { integrator: "bdpt", shadowRays: "per-pair" };
    fill(`integrator-${name}`, status.choices.integrators, lane?.integrator, other.integrator);
    fill(`shadow-${name}`, status.choices.shadowRays, lane?.shadowRays, other.shadowRays);
  }
  say(button("begin-b"), status.split ? "Restart with it" : "Compare");
  box("unsplit").hidden = !status.split;
  enable(status);
}

/**
 * Shows what a lane uses; what was chosen for one that is not there stays.
 * @param {string} id
 * @param {string[]} names
 * @param {string | undefined} used
 * @param {string} other
 */
function fill(id, names, used, other) {
  const list = select(id);
  const isNew = list.dataset.used !== (used ?? "");
  if (!isNew && list.options.length >= names.length) return;
  choose(list, names, used ?? (list.value || other));
  list.dataset.used = used ?? "";
}
