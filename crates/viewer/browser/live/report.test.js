// The report of an experiment: one page, opened from a file, that loads nothing.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import test, { after, afterEach, before } from "node:test";
import { pathToFileURL } from "node:url";
import { BIDIR, MISSING, NARROW, ROOT, WIDE, keep, launch, open } from "../stand.js";

/** @import { Browser, Page } from "playwright-core" */
/** @import { Claim, Plot, Report } from "../../../lab/page/results.js" */

const skip = MISSING ?? false;

/** A text that would be markup, and would end a script. */
const HOSTILE = "</script><img src=x onerror=alert(1)>\"'&\u0007";

const DESCRIPTION = `
title = "Shadow rays"
description = """First.

Second."""
pyramid = "all"
pyramid-spp = 4
seeds = 2
size = "48x36"
[[scene]]
file = "${ROOT}/scenes/room-direct.pbrt"
reference-spp = 256
[[scene]]
file = "${ROOT}/scenes/cornell.pbrt"
reference-spp = 256
[[method]]
name = "all"
[[method]]
name = "one per pair"
shadow-rays = "per-pair"
[[budget]]
samples = 2
[[budget]]
samples = 4
[[budget]]
samples = 8
`;

/** @type {Plot} */
const HISTOGRAM = {
  caption: "A histogram.",
  kind: "histogram",
  x: { label: "rays", scale: "linear" },
  y: { label: "share", scale: "linear" },
  series: [{ name: HOSTILE, points: [[0, 0.25], [1, 0.5], [2, 0.25]], intervals: [[0.2, 0.3], [0.4, 0.6], [0.2, 0.3]] }],
};

/** @type {Claim[]} A description without claims of its own has none. */
const CLAIMS = /** @type {Claim["verdict"][]} */ (["reproduced", "not-met", "undecided"]).map((verdict) => ({
  id: `claim-${verdict}`,
  claim: `The claim is ${verdict} ${HOSTILE}`,
  source: "[Veach97, §10.3]",
  verdict,
  found: "It is 2.1 [1.9, 2.3].",
  method: "Eight seeds.",
  tables: [{ caption: "A table.", columns: ["method", "relmse"], rows: [["all", { value: 0.85, low: 0.82, high: 0.88 }], [HOSTILE, 1.25], ["none", null]] }],
  plots: [HISTOGRAM],
}));

/** @type {Browser} */
let browser;
/** @type {string} */
let folder;
/** @type {string} The report as it was written. */
let plain;
/** @type {string} One with claims. */
let claimed;
/** @type {Page} */
let page;
/** @type {string[]} */
let faults = [];

before(async () => {
  if (skip) return;
  folder = mkdtempSync(path.join(tmpdir(), "bidir-report-"));
  writeFileSync(path.join(folder, "test.toml"), DESCRIPTION);
  execFileSync(BIDIR, ["experiment", "test.toml", "-o", "out", "--quiet"], { cwd: folder, stdio: "pipe" });
  plain = path.join(folder, "out", "report.html");
  claimed = path.join(folder, "claims.html");
  writeFileSync(claimed, withClaims(readFileSync(plain, "utf8")));
  browser = await launch();
  ({ page, faults } = await openFile(claimed));
});
afterEach(() => assert.deepEqual(faults, []));
after(async () => {
  await browser?.close();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

/** @param {string} html */
function withClaims(html) {
  const begin = html.indexOf('id="data">') + 'id="data">'.length;
  const end = html.indexOf("</script>", begin);
  /** @type {Report} */
  const data = JSON.parse(html.slice(begin, end));
  data.results.claims = CLAIMS;
  return html.slice(0, begin) + JSON.stringify(data).replaceAll("<", "\\u003c") + html.slice(end);
}

/** @param {string} file */
async function openFile(file, viewport = WIDE) {
  const opened = await open(browser, pathToFileURL(file).href, viewport);
  await opened.page.context().setOffline(true);
  await opened.page.reload();
  return opened;
}

test("the page shows what was found, and loads nothing", { skip }, async () => {
  assert.equal(await page.textContent("h1"), "Shadow rays");
  assert.deepEqual(await page.locator("header p").allTextContents(), ["First.", "Second."]);
  assert.match((await page.textContent("#verdicts")) ?? "", /3 claims: 1 reproduced, 1 not met, 1 undecided\./);
  const badges = await page.locator("#claims .verdict").allTextContents();
  assert.deepEqual(badges, ["✔ reproduced", "✘ not met", "? undecided"]);
  const setting = (await page.textContent("#setting")) ?? "";
  for (const part of ["24 renders of 2 scenes, 2 methods and 3 budgets, with 2 seeds", "shadow-rays", "per-pair", "48 × 36", "Seeds0–1"]) {
    assert.ok(setting.includes(part), part);
  }
  assert.ok((await page.locator("#more svg .series").count()) >= 8, "curves of two scenes");
  assert.equal(await page.locator("#more svg").count(), await page.locator("#more figure details").count());
  assert.match((await page.textContent("#again")) ?? "", /bidir experiment test\.toml -o FOLDER/);
  assert.match((await page.textContent("#glossary")) ?? "", /relmse_block.*flip_hdr.*ratioRatios are/s);
  assert.match((await page.textContent("footer")) ?? "", /has \d.*B and loads nothing/);
  assert.equal(await page.evaluate(() => performance.getEntriesByType("resource").length), 0);
});

test("texts stay texts, and the best are marked", { skip }, async () => {
  assert.equal(await page.locator("img").count(), 0);
  assert.equal(await page.locator("script").count(), 2);
  assert.ok((await page.locator("#claim-1 h3").textContent())?.includes(HOSTILE));
  const cells = page.locator("#claim-1 table").first().locator("td.number");
  assert.deepEqual(await cells.allTextContents(), ["0.85 [0.82, 0.88]★", "1.25", "no number"]);
  assert.ok((await page.locator("#more td.best").count()) > 0);
});

test("strategies are tiles, and a table has their numbers", { skip }, async () => {
  const tiles = page.locator("#strategies article").first().locator("details").first().locator(".tile");
  const rows = page.locator("#strategies article").first().locator("tbody tr");
  assert.equal(await tiles.count(), await rows.count(), "all strategies, longer paths and the picture");
  const ink = await tiles.first().locator("canvas").evaluate((canvas) => {
    const { width, height } = /** @type {HTMLCanvasElement} */ (canvas);
    const context = /** @type {HTMLCanvasElement} */ (canvas).getContext("2d");
    return [...(context?.getImageData(0, 0, width, height).data ?? [])].filter((value, i) => i % 4 < 3 && value > 40).length;
  });
  assert.ok(ink > 300, `${ink} channels of the picture are lit`);
});

/** The pixels of the canvas. */
function picture() {
  return page.locator("#stage").screenshot();
}

/** A change that can be seen, and whose reverse brings back what was before. @param {() => Promise<unknown>} there @param {() => Promise<unknown>} back */
async function thereAndBack(there, back) {
  const before = await picture();
  await there();
  const between = await picture();
  await back();
  return !before.equals(between) && before.equals(await picture());
}

test("images flip at the same place, as light and as errors", { skip }, async () => {
  await page.locator("#stage").focus();
  const press = (/** @type {string} */ key) => () => page.keyboard.press(key);
  const set = (/** @type {string} */ id, /** @type {string} */ value) => () => page.selectOption(`#${id}`, value);
  for (const [there, back] of [["f", " "], ["s", "s"], ["]", "["], ["+", "r"], ["ArrowLeft", "ArrowRight"], ["3", "2"]]) {
    await page.locator("#stage").focus();
    assert.ok(await thereAndBack(press(there), press(back)), `keys ${there} and ${back}`);
  }
  for (const layer of ["relative", "flip"]) {
    assert.ok(await thereAndBack(set("layer", layer), set("layer", "image")), layer);
    await set("layer", layer)();
    assert.match((await page.textContent("#shown")) ?? "", /mean 0?\.?\d/);
    await keep(page, `report-${layer}`);
    await set("layer", "image")();
  }
  for (const tone of ["agx", "neutral", "linear", "false"]) assert.ok(await thereAndBack(set("operator", tone), set("operator", "srgb")), tone);
  assert.ok(await thereAndBack(() => page.selectOption("#scene", { index: 1 }), () => page.selectOption("#scene", { index: 0 })), "scenes");
  await page.click("#reset");
  assert.ok(await thereAndBack(() => page.click("#flip"), () => page.click("#flip")), "the button flips");
});

test("a divided image has its border where the hand puts it, and pixels have values", { skip }, async () => {
  await page.check("#is-split");
  const divided = await picture();
  await page.locator("#divider").focus();
  await page.keyboard.press("PageUp");
  assert.ok(!divided.equals(await picture()));
  await page.click("#reset");
  await page.locator("#stage").hover();
  const text = (await page.textContent("#figures")) ?? "";
  assert.match(text, /^pixel \(\d+, \d+\)\nA( +[0-9.e-]+){3}\nB( +[0-9.e-]+){3}\nreference( +[0-9.e-]+){3}$/);
  const [b, reference] = text.split("\n").slice(2).map((line) => line.replace(/^\w+/, "").trim());
  assert.equal(b, reference, "B is the reference");
});

test("the page fits narrow and wide windows, in light and in the dark, and on paper", { skip }, async () => {
  for (const viewport of [WIDE, NARROW]) {
    const { page, faults } = await openFile(claimed, viewport);
    for (const colorScheme of /** @type {("light" | "dark")[]} */ (["light", "dark"])) {
      await page.emulateMedia({ colorScheme });
      const width = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(width <= viewport.width, `${width} pixels in a window of ${viewport.width}`);
      await keep(page, `report-${colorScheme}`, { fullPage: true });
    }
    await page.emulateMedia({ media: "print" });
    assert.equal(await page.locator(".controls").isVisible(), false);
    await page.close();
    assert.deepEqual(faults, []);
  }
});

test("requests, foreign scripts and foreign styles are refused", { skip }, async () => {
  const own = await browser.newPage();
  await own.goto(pathToFileURL(plain).href);
  const refused = await own.evaluate(async () => {
    /** @type {string[]} */
    const refused = [];
    document.addEventListener("securitypolicyviolation", (event) => refused.push(event.effectiveDirective));
    const image = document.createElement("img");
    image.src = "no-such-image.png";
    const script = document.createElement("script");
    script.textContent = "window.broken = true";
    const style = document.createElement("style");
    style.textContent = "body { display: none }";
    document.body.append(image, script, style);
    await fetch("no-such-file.json").catch(() => null);
    await new Promise((resolve) => setTimeout(resolve, 300));
    return refused.sort();
  });
  assert.deepEqual(refused, ["connect-src", "img-src", "script-src-elem", "style-src-elem"]);
  await own.close();
});

test("without JavaScript the page says so", { skip }, async () => {
  const context = await browser.newContext({ javaScriptEnabled: false });
  const bare = await context.newPage();
  await bare.goto(pathToFileURL(plain).href);
  assert.match((await bare.textContent("noscript")) ?? "", /This page needs JavaScript/);
  assert.ok(await bare.locator("noscript p").first().isVisible());
  await context.close();
});
