// Steering: methods side by side, the camera, strategies, a sample.

import assert from "node:assert/strict";
import path from "node:path";
import test, { after, afterEach, before } from "node:test";
import { MISSING, NARROW, ROOT, Renderer, WIDE, keep, launch, open } from "../stand.js";

/** @import { Browser, Page } from "playwright-core" */

const SCENE = path.join(ROOT, "scenes", "cornell.pbrt");
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
  renderer = await Renderer.start(["view", SCENE, "--port", "0", "--size", "128x128"]);
  ({ page, faults } = await open(browser, renderer.url));
});
afterEach(() => assert.deepEqual(faults ?? [], []));
after(async () => {
  await browser?.close();
  await renderer?.end();
});

/** Looks at the page in both sizes. @param {string} name */
async function keepBoth(name) {
  await keep(page, name);
  await page.setViewportSize(NARROW);
  await page.waitForTimeout(200);
  await keep(page, name);
  await page.setViewportSize(WIDE);
}

test("another method begins the render anew", { skip }, async () => {
  const { generation } = (await renderer.until(({ lanes }) => lanes[0]?.passes >= 2)).lanes[0];
  // The list has its values with the first status, and nothing is to be begun yet.
  await page.waitForSelector("#shadow-a[data-used]");
  await page.waitForSelector("#begin-a:disabled");
  await page.selectOption("#shadow-a", "per-light-vertex");
  await page.click("#begin-a");
  const { lanes } = await renderer.until(({ lanes }) => lanes[0].shadowRays === "per-light-vertex");
  assert.ok(lanes[0].generation > generation);
});

test("two shadow-ray rules side by side, at equal time", { skip }, async () => {
  await page.selectOption("#integrator-b", "bdpt");
  await page.selectOption("#shadow-b", "per-pair");
  await page.click("#begin-b");
  const { lanes } = await renderer.until(({ split, lanes }) => split && lanes.every(({ passes }) => passes >= 6));
  assert.deepEqual(lanes.map(({ shadowRays }) => shadowRays), ["per-light-vertex", "per-pair"]);
  const [a, b] = lanes.map(({ seconds, passes }) => ({ seconds, pass: seconds / passes }));
  assert.ok(Math.abs(a.seconds - b.seconds) <= 3 * Math.max(a.pass, b.pass), `${a.seconds} s and ${b.seconds} s`);
  const divider = page.locator("#divider");
  await divider.waitFor();
  assert.equal(await divider.getAttribute("aria-valuenow"), "50");
  await divider.focus();
  for (let i = 0; i < 5; i++) await page.keyboard.press("ArrowRight");
  await page.waitForSelector('#divider[aria-valuenow="60"]');
  const box = await divider.boundingBox();
  const stage = await page.locator("#stage").boundingBox();
  assert.ok(box && stage);
  await page.mouse.move(box.x + box.width / 2, box.y + 60);
  await page.mouse.down();
  await page.mouse.move(stage.x + 0.3 * stage.width, box.y + 60, { steps: 5 });
  await page.mouse.up();
  await page.waitForSelector('#divider[aria-valuenow="30"]');
  await page.waitForFunction(() => document.querySelectorAll("#chart .series").length === 2);
  await page.waitForTimeout(1500);
  await keepBoth("split");
  await page.click("#unsplit");
  await renderer.until(({ split }) => !split);
  await divider.waitFor({ state: "hidden" });
});

test("dragging orbits the camera: the render restarts as a preview, and home brings it back", { skip }, async () => {
  const before = await renderer.until(({ lanes }) => lanes[0].passes >= 2);
  assert.ok(before.camera && !before.camera.moved);
  await page.click("#modes label:has(input[value=move])");
  const stage = await page.locator("#stage").boundingBox();
  assert.ok(stage);
  const [x, y] = [stage.x + stage.width / 2, stage.y + stage.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 60, y + 10, { steps: 6 });
  const moving = await renderer.until(({ camera }) => camera?.moved === true);
  assert.ok(moving.lanes[0].generation > before.lanes[0].generation);
  await page.mouse.up();
  const after = await renderer.until(({ lanes }) => !lanes[0].preview && lanes[0].passes >= 1);
  assert.notDeepEqual(after.camera?.origin, before.camera.origin);
  await page.waitForTimeout(500);
  await keepBoth("moved");
  await page.focus("#stage");
  await page.keyboard.down("KeyW");
  await page.waitForTimeout(300);
  await page.keyboard.up("KeyW");
  await renderer.until(({ camera }) => JSON.stringify(camera?.target) !== JSON.stringify(after.camera?.target));
  await page.keyboard.press("h");
  await renderer.until(({ camera, lanes }) => camera?.moved === false && !lanes[0].preview);
});

test("one sample's subpaths are drawn over the picture", { skip }, async () => {
  await page.click("#modes label:has(input[value=sample])");
  const stage = await page.locator("#stage").boundingBox();
  assert.ok(stage);
  await page.mouse.click(stage.x + 0.45 * stage.width, stage.y + 0.7 * stage.height);
  await page.waitForSelector("#sample-list table");
  const pixel = [await page.inputValue("#sample-x"), await page.inputValue("#sample-y")];
  const told = JSON.parse(String(await renderer.bytes(`/sample?lane=a&x=${pixel[0]}&y=${pixel[1]}&pass=0`)));
  const seen = told.camera.vertices.filter((/** @type {{raster: unknown}} */ vertex) => vertex.raster).length;
  assert.ok(seen >= 1);
  await page.waitForFunction((count) => document.querySelectorAll("#drawing circle.camera-path").length === count, seen);
  const rows = await page.locator("#sample-list tr:has(td.fate)").count();
  assert.equal(rows, told.candidates.length + told.hits.length + told.light_image.length);
  const ends = told.candidates.filter((/** @type {any} */ candidate) => candidate.light_end.raster && told.camera.vertices[candidate.t - 1].raster);
  assert.equal(await page.locator("#drawing line.ray").count(), ends.length);
  await keepBoth("sample");
  await page.fill("#sample-pass", "1");
  await page.click("#sample-form button[type=submit]");
  await page.waitForFunction(() => document.querySelector("#sample-list")?.textContent?.includes("pass 1"));
  await page.click("#sample-clear");
  await page.waitForFunction(() => document.querySelectorAll("#drawing .camera-path").length === 0);
  await page.click("#modes label:has(input[value=look])");
});

test("the pyramid of strategies has a tile for each, with its figures", { skip }, async () => {
  await page.click("#tab-strategies");
  await page.fill("#strategy-vertices", "4");
  await page.click("#strategies-keep");
  await renderer.until(({ lanes }) => lanes[0].strategyVertices === 4 && lanes[0].passes >= 4);
  await page.waitForSelector("#tile-2-2");
  // (0, 2) to (3, 1): two, three and four in a row, but those that the renderer does not have.
  const told = JSON.parse(String(await renderer.bytes("/strategies?lane=a")));
  assert.equal(await page.locator(".tile").count(), told.tiles.length);
  const isLoaded = () => [...document.querySelectorAll(".tile img")].every((image) => image instanceof HTMLImageElement && image.naturalWidth > 0);
  await page.waitForFunction(isLoaded);
  await keepBoth("strategies");
  await page.click("#tile-1-2");
  await page.waitForSelector("#large[open]");
  assert.match((await page.textContent("#large-title")) ?? "", /s = 1, t = 2/);
  await keep(page, "strategy");
  await page.keyboard.press("Escape");
  await page.selectOption("#strategies-kind", "raw");
  await page.waitForFunction(() => document.querySelector("#tile-1-2 img")?.getAttribute("src")?.includes("kind=raw"));
  await page.waitForFunction(isLoaded);
  await keep(page, "strategies-raw");
});

test("stopping ends the render, which is still shown", { skip }, async () => {
  await page.click("#tab-render");
  await page.click("#stop");
  await renderer.until(({ state }) => state === "done");
  await page.waitForSelector('#state[data-state="done"]');
  assert.ok(await page.isDisabled("#pause"));
  await page.click("#restart");
  await renderer.until(({ state, lanes }) => state === "rendering" && lanes[0].passes >= 1);
});
