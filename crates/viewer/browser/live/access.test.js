// For everybody: two sizes, the keyboard alone, a server that goes away, one that only shows, and a
// browser without WebGL2.

import assert from "node:assert/strict";
import path from "node:path";
import test, { after, before } from "node:test";
import { MISSING, NARROW, ROOT, Renderer, WIDE, keep, launch, open } from "../stand.js";

/** @import { Browser, Page } from "playwright-core" */

const SCENE = path.join(ROOT, "scenes", "cornell.pbrt");
const skip = MISSING ?? false;

/** @type {Browser} */
let browser;
/** @type {Renderer} */
let renderer;

before(async () => {
  if (skip) return;
  browser = await launch();
  renderer = await Renderer.start(["view", SCENE, "--port", "0", "--size", "96x96"]);
  await renderer.until(({ lanes }) => lanes[0]?.passes >= 1);
});
after(async () => {
  await browser?.close();
  await renderer?.end();
});

/** Pairs of controls that lie over each other. @param {Page} page */
function overlaps(page) {
  return page.evaluate(() => {
    const controls = [...document.querySelectorAll("button, select, input:not([type=radio]), .choices label, a.button")];
    const boxes = controls.flatMap((element) => {
      const box = element.getBoundingClientRect();
      const isSeen = box.width > 0 && !element.closest("dialog, #stage") && element.checkVisibility();
      return isSeen ? [{ name: element.id || element.textContent, box }] : [];
    });
    return boxes.flatMap((a, i) =>
      boxes.slice(i + 1).flatMap((b) => {
        const width = Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left);
        const height = Math.min(a.box.bottom, b.box.bottom) - Math.max(a.box.top, b.box.top);
        return width > 1 && height > 1 ? [`${a.name} and ${b.name}`] : [];
      }),
    );
  });
}

for (const [name, size] of /** @type {[string, typeof WIDE][]} */ ([["1280 x 800", WIDE], ["390 x 844", NARROW]])) {
  test(`nothing is cut off or overlaps at ${name}`, { skip }, async () => {
    const { page, faults } = await open(browser, renderer.url, size);
    await page.waitForSelector("#figures td");
    for (const tab of ["render", "pixel", "sample", "strategies"]) {
      await page.click(`#tab-${tab}`);
      const width = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(width <= size.width, `${tab}: ${width} pixels are needed`);
      assert.deepEqual(await overlaps(page), [], tab);
      const cut = await page.evaluate(() =>
        [...document.querySelectorAll("button, select, input, .button")]
          .filter((element) => element.checkVisibility() && !element.closest(".choices, dialog"))
          .filter((element) => {
            const { left, right } = element.getBoundingClientRect();
            return left < 0 || right > innerWidth;
          })
          .map((element) => element.id),
      );
      assert.deepEqual(cut, [], tab);
      await keep(page, `tab-${tab}`);
    }
    await page.click("#help");
    await keep(page, "keys");
    assert.deepEqual(faults, []);
    await page.close();
  });
}

test("every control has a name", { skip }, async () => {
  const { page } = await open(browser, renderer.url);
  await page.waitForSelector("#figures td");
  const nameless = await page.evaluate(() =>
    [...document.querySelectorAll("button, select, input, [tabindex='0']")]
      .filter((element) => {
        const labels = "labels" in element ? /** @type {HTMLInputElement} */ (element).labels : null;
        return !(labels?.length || element.getAttribute("aria-label") || element.textContent?.trim());
      })
      .map((element) => element.outerHTML),
  );
  assert.deepEqual(nameless, []);
  await page.close();
});

/** Goes on by the tabulator until an element has the focus. @param {Page} page @param {string} id */
async function reach(page, id) {
  for (let i = 0; i < 60; i++) {
    await page.keyboard.press("Tab");
    const at = await page.evaluate(() => document.activeElement?.id);
    if (at !== id) continue;
    const outline = await page.evaluate(() => getComputedStyle(/** @type {Element} */ (document.activeElement)).outlineStyle);
    assert.notEqual(outline, "none", `the focus on ${id} is not seen`);
    return;
  }
  assert.fail(`${id} is not reached by the keyboard`);
}

test("the keyboard alone: pause, exposure, zoom, a pixel, tabs, a comparison", { skip }, async () => {
  const { page, faults } = await open(browser, renderer.url);
  await page.waitForSelector("#figures td");
  await reach(page, "pause");
  await page.keyboard.press("Enter");
  await renderer.until(({ state }) => state === "paused");
  await reach(page, "exposure");
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => document.getElementById("exposure-value")?.textContent === "+0.25");
  await reach(page, "stage");
  const zoom = await page.textContent("#zoom-value");
  await page.keyboard.press("+");
  await page.waitForFunction((before) => document.getElementById("zoom-value")?.textContent !== before, zoom);
  await page.keyboard.press("Shift+ArrowRight");
  await page.waitForSelector('#pixel-tables[data-pixel="49,48"]', { state: "attached" });
  await page.keyboard.press("Shift+ArrowDown");
  await page.waitForSelector('#pixel-tables[data-pixel="49,49"]', { state: "attached" });
  await page.keyboard.press("?");
  await page.waitForSelector("#keys[open]");
  await page.keyboard.press("Escape");
  await page.focus("#stage");
  await page.keyboard.press("Tab");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowLeft");
  const tab = await page.evaluate(() => document.querySelector('[role="tab"][aria-selected="true"]')?.id);
  assert.equal(tab, await page.evaluate(() => document.activeElement?.id));
  await page.keyboard.press("Home");
  while ((await page.evaluate(() => document.activeElement?.id)) !== "tab-render") await page.keyboard.press("ArrowLeft");
  await keep(page, "keyboard");
  await reach(page, "begin-b");
  await page.keyboard.press("Enter");
  await renderer.until(({ split }) => split);
  await reach(page, "unsplit");
  await page.keyboard.press("Enter");
  await renderer.until(({ split }) => !split);
  assert.deepEqual(faults, []);
  await page.close();
});

test("a server that goes away is missed, and found again when it is back", { skip }, async () => {
  const port = String(20000 + (process.pid % 20000));
  const args = ["view", SCENE, "--port", port, "--size", "64x64"];
  let other = await Renderer.start(args);
  const { page } = await open(browser, other.url);
  await page.waitForSelector("#figures td");
  await page.click("#restart");
  await other.until(({ lanes }) => lanes[0].generation >= 2);
  await page.click("#tab-sample");
  for (const id of ["#sample-x", "#sample-y"]) await page.fill(id, "32");
  await page.click("#sample-form button[type=submit]");
  await page.waitForSelector("#sample-list table");
  await other.end();
  await page.waitForSelector("#notice:not([hidden])");
  assert.match((await page.textContent("#notice")) ?? "", /does not answer/);
  await keep(page, "away");
  other = await Renderer.start(args);
  await page.waitForSelector("#notice[hidden]", { state: "attached" });
  await page.waitForFunction(() => document.getElementById("state")?.dataset.state !== "away");
  // A sample of the server before is none of this one's.
  await page.waitForSelector("#sample-list table", { state: "detached" });
  await page.close();
  await other.end();
});

test("a render that is only shown has nothing that steers", { skip }, async () => {
  const served = await Renderer.start(["render", SCENE, "--serve", "127.0.0.1:0", "--size", "96x96", "--time", "10m", "-o", "out.exr"]);
  const { page, faults } = await open(browser, served.url);
  await page.waitForSelector("#figures td");
  for (const id of ["transport", "methods", "save-there"]) assert.ok(await page.isHidden(`#${id}`), id);
  assert.ok(await page.isHidden("#modes label:has(input[value=move])"));
  assert.ok(await page.isVisible("#exr-a"));
  await keep(page, "only-shown");
  assert.deepEqual(faults, []);
  await page.close();
  await served.end();
});

test("a page on all addresses has a token, and passes it on", { skip }, async () => {
  const shared = await Renderer.start(["view", SCENE, "--bind", "0.0.0.0", "--port", "0", "--size", "64x64"]);
  const url = new URL(shared.url);
  assert.ok((url.searchParams.get("token") ?? "").length >= 16, shared.url);
  url.hostname = "127.0.0.1";
  const { page, faults } = await open(browser, url.href);
  await page.waitForSelector("#figures td");
  await page.click("#tab-pixel");
  await page.fill("#pixel-x", "9");
  await page.fill("#pixel-y", "9");
  await page.waitForFunction(() => /[1-9]/.test(document.getElementById("brief")?.textContent ?? ""));
  await page.click("#pixel-form button");
  await page.waitForSelector('#pixel-tables[data-pixel="9,9"]');
  assert.equal((await fetch(new URL("/status", url))).status, 403);
  assert.deepEqual(faults, []);
  await page.close();
  await shared.end();
});

test("without WebGL2 the page says so and shows the server's PNG", { skip }, async () => {
  const page = await browser.newPage({ viewport: WIDE });
  await page.addInitScript(() => {
    const known = HTMLCanvasElement.prototype.getContext;
    // @ts-expect-error: one signature stands for all of them
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind === "webgl2" ? null : known.call(this, kind, ...rest);
    };
  });
  await page.goto(renderer.url);
  await page.waitForFunction(() => {
    const image = document.getElementById("plain");
    return image instanceof HTMLImageElement && image.naturalWidth === 96;
  });
  const before = await page.locator("#plain").boundingBox();
  await page.click("#zoom-in");
  await page.waitForFunction((width) => (document.getElementById("plain")?.clientWidth ?? 0) > 1.3 * width, before?.width ?? 0);
  assert.match((await page.textContent("#plain-note:visible")) ?? "", /no WebGL2/);
  await keep(page, "plain");
  await page.close();
});
