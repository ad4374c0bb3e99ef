// Tables: numbers to the right, the best of them marked.
//
// The head of a column says which of its numbers are good, as in papers: `↓` at its end means that less
// is better, `↑` more. Names of metrics mean `↓`, and efficiencies `↑`, without it. Rows that agree in
// all but the last of the texts at their beginning are compared with each other: the methods of one
// scene and budget.

import { make } from "./dom.js";
import { METRICS } from "./glossary.js";
import { interval, number } from "./number.js";

/** @import { Cell, Table } from "./results.js" */

/** @typedef {"best" | "as-good" | "none"} Rank */

/** A value with the better and the worse end of its interval; less is better. @typedef {[number, number, number]} Bounds */

/** A longer text is divided into lines. Unit: characters. */
const LONGEST_NAME = 28;

/** The text of a missing number. */
export const NOTHING = "–";

const MARKS = {
  best: ["★", "best"],
  "as-good": ["≈", "the interval overlaps that of the best"],
  none: ["", ""],
};

/**
 * A table of the page.
 * @param {Table} table
 */
export function tableOf(table) {
  const all = table.columns.map((_, column) => ranks(table, column));
  const heads = table.columns.map((words, column) => {
    const isNumeric = table.rows.some((row) => column < row.length && typeof row[column] !== "string");
    return make("th", { scope: "col", class: isNumeric ? "number" : "" }, [words]);
  });
  const rows = table.rows.map((row, i) => make("tr", {}, row.map((cell, column) => cellOf(cell, all[column]?.[i] ?? "none"))));
  const caption = table.caption === "" ? [] : [make("caption", {}, [table.caption])];
  const parts = [...caption, make("thead", {}, [make("tr", {}, heads)]), make("tbody", {}, rows)];
  const isMarked = all.flat().some((rank) => rank !== "none");
  const legend = "★ best of the rows that are compared; ≈ not significantly different: the intervals overlap.";
  return make("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": table.caption || "table" }, [
    make("table", {}, parts),
    ...(isMarked ? [make("p", { class: "note" }, [legend])] : []),
  ]);
}

/**
 * @param {Cell} cell
 * @param {Rank} rank
 */
function cellOf(cell, rank) {
  if (typeof cell === "string" && cell !== NOTHING) {
    // A name stays on its line; a sentence does not.
    return make("td", { class: cell.length <= LONGEST_NAME ? "name" : "" }, [cell]);
  }
  const [symbol, title] = MARKS[rank];
  return make("td", { class: rank === "best" ? "number best" : "number" }, [written(cell), make("span", { class: "mark", title }, [symbol])]);
}

/** @param {Cell} cell */
function written(cell) {
  if (typeof cell === "string") return cell;
  return cell !== null && typeof cell === "object" ? interval(cell.value, cell.low, cell.high) : number(cell);
}

/**
 * 1 where less is better, -1 where more is, 0 where neither is.
 * @param {string} head
 */
function direction(head) {
  const name = head.trimEnd();
  if (name.endsWith("↓") || METRICS.has(name)) return 1;
  return name.endsWith("↑") || name.startsWith("efficiency") ? -1 : 0;
}

/**
 * The rank of every row's number in a column.
 * @param {Table} table
 * @param {number} column
 * @returns {Rank[]}
 */
export function ranks({ columns, rows }, column) {
  const sign = direction(columns[column]);
  if (sign === 0) return rows.map(() => "none");
  const keys = rows.map(key);
  const bounds = rows.map((row) => boundsOf(row[column], sign));
  return bounds.map((own, i) => {
    const rivals = bounds.filter((other, j) => other && keys[j] === keys[i]).map((other) => /** @type {Bounds} */ (other));
    // A number alone is not the best of anything.
    if (!own || rivals.length < 2) return "none";
    const best = rivals.reduce((a, b) => (b[0] < a[0] ? b : a));
    if (own[0] <= best[0]) return "best";
    return own[1] <= best[2] ? "as-good" : "none";
  });
}

/**
 * The bounds of a number; one without an interval has ends that overlap nothing. Null: not finite.
 * @param {Cell | undefined} cell
 * @param {number} sign
 * @returns {Bounds | null}
 */
function boundsOf(cell, sign) {
  if (typeof cell === "number") return [sign * cell, Infinity, -Infinity];
  if (typeof cell !== "object" || cell === null || cell.value === null) return null;
  const ends = [cell.low ?? -Infinity, cell.high ?? Infinity].map((end) => sign * end);
  return [sign * cell.value, Math.min(...ends), Math.max(...ends)];
}

/**
 * The texts at the beginning of a row, but for the last of them.
 * @param {Cell[]} row
 */
function key(row) {
  const end = row.findIndex((cell) => typeof cell !== "string");
  return JSON.stringify(row.slice(0, end < 0 ? row.length : end).slice(0, -1));
}
