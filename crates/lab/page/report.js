// The report: what an experiment found, drawn from the data that stand in the page.

import { get } from "./dom.js";
import { compact } from "./format.js";
import { connectImages, images } from "./images.js";
import { again, claims, glossary, header, others, paragraph, setting, verdicts } from "./sections.js";
import { strategies } from "./strategies.js";

/** @import { Report } from "./results.js" */

/**
 * The data of the page. Seeds that a float cannot hold stay texts, where the browser gives them.
 * @returns {Report}
 */
function data() {
  /** @type {(...of: any[]) => unknown} */
  const keep = (key, value, context) => (key === "seed" && !Number.isSafeInteger(value) ? (context?.source ?? String(value)) : value);
  return JSON.parse(get("data", HTMLScriptElement).text, keep);
}

/** The size of the page before anything is drawn. */
const bytes = new TextEncoder().encode(document.documentElement.outerHTML).length;
const report = data();
const main = document.createElement("main");
main.append(
  verdicts(report.results),
  setting(report),
  claims(report.results),
  others(report),
  strategies(report),
  images(report),
  again(report),
  glossary(report),
);
const footer = document.createElement("footer");
footer.append(paragraph(`This page has ${compact(bytes)}B and loads nothing: all it shows is in it.`));
document.body.append(header(report.results), main, footer);
connectImages(report);
