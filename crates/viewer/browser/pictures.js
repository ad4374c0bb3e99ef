// Makes the pictures of README and of the guide that show a page, and JPEGs of renders:
//
//     node pictures.js view OUT.jpg            two integrators side by side in `bidir view`
//     node pictures.js report REPORT.html OUT.jpg   the first chart of an experiment's report
//     node pictures.js strategies REPORT.html OUT.jpg   the strategies of its first scene as tiles
//     node pictures.js photo IN.png OUT.jpg    an image as a JPEG, at its own size

import { readFileSync } from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { MISSING, ROOT, Renderer, launch, open, sleep } from "./stand.js";

/** @import { Browser, Page } from "playwright-core" */

const WINDOW = { width: 1280, height: 800 };
/** Keeps photographs of noise under 200 KB. Unit: percent. */
const QUALITY = 70;
/** The time that both integrators render before the picture is taken. Unit: milliseconds. */
const RENDERING = 40_000;

/** The part of the window above the chart, which shows a table. Unit: pixels. */
const ABOVE_CHART = 240;

/** @param {Page} page @param {string} file */
async function shoot(page, file) {
  await page.screenshot({ path: file, type: "jpeg", quality: QUALITY });
}

/** @param {Browser} browser @param {string} out */
async function view(browser, out) {
  const scene = path.join(ROOT, "scenes", "room-indirect.pbrt");
  const renderer = await Renderer.start(["view", scene, "--port", "0", "--integrator", "path", "--size", "480x360"]);
  try {
    const { page } = await open(browser, renderer.url, WINDOW);
    await page.selectOption("#integrator-b", "lvc");
    await page.click("#begin-b");
    await renderer.until(({ split, lanes }) => split && lanes.every(({ passes }) => passes >= 1));
    await sleep(RENDERING);
    await shoot(page, out);
  } finally {
    await renderer.end();
  }
}

/** @param {Browser} browser @param {string} report @param {string} out */
async function chart(browser, report, out) {
  const page = await browser.newPage({ viewport: WINDOW });
  await page.goto(pathToFileURL(path.resolve(report)).href);
  await page.evaluate((above) => {
    const chart = document.querySelector("figure");
    window.scrollBy({ top: (chart?.getBoundingClientRect().top ?? above) - above, behavior: "instant" });
  }, ABOVE_CHART);
  await shoot(page, out);
}

/** @param {Browser} browser @param {string} report @param {string} out */
async function strategies(browser, report, out) {
  const page = await browser.newPage({ viewport: WINDOW, colorScheme: "dark" });
  await page.goto(pathToFileURL(path.resolve(report)).href);
  await page.locator(".strategies details > .scroll").first().screenshot({ path: out, type: "jpeg", quality: QUALITY });
}

/** @param {Browser} browser @param {string} image @param {string} out */
async function photo(browser, image, out) {
  const page = await browser.newPage();
  const data = readFileSync(image).toString("base64");
  await page.setContent(`<style>body { margin: 0 } img { display: block }</style><img src="data:image/png;base64,${data}">`);
  const box = await page.locator("img").boundingBox();
  if (!box) throw new Error(`${image} is not an image`);
  await page.setViewportSize({ width: box.width, height: box.height });
  await shoot(page, out);
}

/** @type {Record<string, (browser: Browser, ...files: string[]) => Promise<void>>} */
const PICTURES = { view, report: chart, strategies, photo };

const [kind, ...files] = process.argv.slice(2);
const make = PICTURES[kind];
if (!make || files.length !== make.length - 1) {
  console.error("usage: node pictures.js view OUT.jpg | report REPORT.html OUT.jpg | strategies REPORT.html OUT.jpg | photo IN.png OUT.jpg");
  process.exit(2);
}
if (MISSING) throw new Error(MISSING);
const browser = await launch();
try {
  await make(browser, ...files);
} finally {
  await browser.close();
}
