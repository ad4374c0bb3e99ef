// The picture, and the values in it.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import test, { after, afterEach, before } from "node:test";
import { readExr } from "../exr.js";
import { BIDIR, MISSING, ROOT, Renderer, brightness, decode, difference, keep, launch, open } from "../stand.js";

/** @import { Browser, Page } from "playwright-core" */

const SCENE = path.join(ROOT, "scenes", "room-indirect.pbrt");
const skip = MISSING ?? false;

/** @type {Browser} */
let browser;
/** @type {Renderer} */
let renderer;
/** @type {Page} */
let page;
/** @type {string[]} */
let faults;

before(async () => {
  if (skip) return;
  browser = await launch();
  renderer = await Renderer.start(["view", SCENE, "--port", "0", "--size", "64x48"]);
  ({ page, faults } = await open(browser, renderer.url));
});
afterEach(() => assert.deepEqual(faults ?? [], []));
after(async () => {
  await browser?.close();
  await renderer?.end();
});

/** The PNG that the page saves. */
async function shown() {
  const download = page.waitForEvent("download");
  await page.click("#png-shown");
  return readFileSync(await (await download).path());
}

/** Holds the render, so that what is asked for one after the other is of the same passes. */
async function pause() {
  if ((await renderer.status()).state === "rendering") await page.click("#pause");
  await renderer.until(({ state }) => state !== "rendering");
}

/** Begins anew, and holds the render after 1 to 99 passes. Clicks from outside the page are too slow. */
async function restartAndPause() {
  await renderer.until(({ lanes }) => lanes[0]?.passes >= 100);
  await page.waitForFunction(() => /^\d{3,} passes/.test(document.getElementById("brief")?.textContent ?? ""));
  await page.evaluate(async () => {
    const isEarly = () => /^[1-9]\d? pass/.test(document.getElementById("brief")?.textContent ?? "");
    document.getElementById("restart")?.click();
    while (!isEarly()) await new Promise((resolve) => setTimeout(resolve, 10));
    document.getElementById("pause")?.click();
  });
  await renderer.until(({ state }) => state === "paused");
}

/** Renders on, up to at least so many times the passes so far. @param {number} factor */
async function resumeUpTo(factor) {
  const { passes } = (await renderer.status()).lanes[0];
  await page.click("#pause");
  await renderer.until(({ lanes }) => lanes[0].passes >= factor * passes);
  await page.waitForSelector("#pause:text('Pause')");
  await pause();
}

/** Waits until the page has heard of so many passes. @param {number} passes */
async function heardOf(passes) {
  await page.waitForFunction((passes) => new RegExp(`Passes${passes}(?!\\d)`).test(document.getElementById("figures")?.textContent ?? ""), passes);
}

/** The pixels of the page, once the last frame is there. */
async function settled() {
  await heardOf((await renderer.status()).lanes[0].passes);
  await page.waitForTimeout(500);
  return decode(browser, await shown());
}

test("the picture appears and gets less noisy", { skip }, async () => {
  await restartAndPause();
  const early = await settled();
  await resumeUpTo(5);
  const middle = await settled();
  await resumeUpTo(5);
  const late = await settled();
  assert.ok(brightness(early) > 5, `brightness ${brightness(early)}`);
  // Noise above white is cut, so that a single pass is darker by a quarter; 5 passes by 5 %.
  const growth = brightness(late) / brightness(middle) - 1;
  assert.ok(Math.abs(growth) < 0.1, `brightness changes by ${growth}`);
  const [first, second] = [difference(early, late), difference(middle, late)];
  assert.ok(second > 0 && second < 0.7 * first, `it is off by ${first}, then by ${second}`);
  await keep(page, "render");
});

test("exposure changes the picture, and pausing stops the samples", { skip }, async () => {
  await pause();
  const { passes } = (await renderer.status()).lanes[0];
  const before = brightness(await decode(browser, await shown()));
  await page.locator("#exposure").fill("2");
  const brighter = brightness(await decode(browser, await shown()));
  assert.ok(brighter > 1.3 * before, `${before}, then ${brighter}`);
  await page.locator("#exposure").fill("0");
  const again = (await renderer.status()).lanes[0].passes;
  assert.equal(again, passes);
  await heardOf(passes);
});

test("the picture is what `bidir tonemap` makes of the saved EXR", { skip }, async () => {
  await pause();
  const exr = path.join(renderer.folder, "saved.exr");
  const png = path.join(renderer.folder, "mapped.png");
  writeFileSync(exr, await renderer.bytes("/render.exr?lane=a"));
  for (const [operator, exposure] of /** @type {[string, number][]} */ ([["srgb", 0], ["srgb", -2.5], ["agx", 0], ["agx", 3], ["neutral", 0], ["neutral", 2]])) {
    await page.selectOption("#operator", operator);
    await page.locator("#exposure").fill(String(exposure));
    execFileSync(BIDIR, ["tonemap", exr, "-o", png, `--exposure=${exposure}`, "--operator", operator], { stdio: "pipe" });
    const [page_, command] = [await decode(browser, await shown()), await decode(browser, readFileSync(png))];
    assert.deepEqual([page_.width, page_.height], [command.width, command.height]);
    const off = page_.data.reduce((most, value, i) => Math.max(most, Math.abs(value - command.data[i])), 0);
    assert.ok(off <= 1, `${operator}, ${exposure} stops: off by ${off} of 255`);
  }
  await page.selectOption("#operator", "false");
  await page.locator("#exposure").fill("0");
  await keep(page, "false-colour");
  await page.selectOption("#operator", "srgb");
});

test("the inspector shows the values of the saved EXR", { skip }, async () => {
  await pause();
  const download = page.waitForEvent("download");
  await page.click("#exr-a");
  const { width, channels } = readExr(readFileSync(await (await download).path()));
  await page.click("#tab-pixel");
  for (const [x, y] of [[0, 0], [17, 40], [32, 24], [63, 47]]) {
    await page.fill("#pixel-x", String(x));
    await page.fill("#pixel-y", String(y));
    await page.click("#pixel-form button");
    await page.waitForSelector(`#pixel-tables[data-pixel="${x},${y}"]`);
    const told = await page.locator("#pixel-tables td:nth-of-type(1)").allTextContents();
    const stored = ["R", "G", "B"].map((name) => channels.get(name)?.[y * width + x]);
    assert.deepEqual(told.slice(0, 3).map((text) => Math.fround(Number(text))), stored, `pixel ${x}, ${y}`);
    const errors = (await page.locator("#pixel-tables td:nth-of-type(2)").allTextContents()).slice(0, 3);
    assert.ok(errors.every((text) => Number(text.replace("± ", "")) >= 0), String(errors));
  }
});

test("a click chooses the pixel under it, whose values are written where it is large", { skip }, async () => {
  await page.click("#zoom-fit");
  const stage = await page.locator("#stage").boundingBox();
  assert.ok(stage);
  const [x, y] = [stage.x + 0.4 * stage.width, stage.y + 0.6 * stage.height];
  await page.mouse.move(x, y);
  const hovered = (await page.textContent("#hover"))?.match(/^(\d+), (\d+)/);
  assert.ok(hovered);
  await page.mouse.click(x, y);
  await page.waitForSelector(`#pixel-tables[data-pixel="${hovered[1]},${hovered[2]}"]`);
  await keep(page, "pixel");
  for (let i = 0; i < 12; i++) await page.mouse.wheel(0, -200);
  await page.waitForTimeout(200);
  assert.equal((await page.textContent("#hover"))?.match(/^\d+, \d+/)?.[0], hovered[0], "zooming keeps the pixel under the hand");
  const ink = await page.evaluate(() => {
    const canvas = /** @type {HTMLCanvasElement} */ (document.getElementById("values"));
    const { data } = canvas.getContext("2d")?.getImageData(0, 0, canvas.width, canvas.height) ?? { data: [] };
    return [...data].filter((_, i) => i % 4 === 3).filter((alpha) => alpha > 0).length;
  });
  assert.ok(ink > 1000, `${ink} points have ink`);
  await keep(page, "values");
  await page.click("#zoom-fit");
});
