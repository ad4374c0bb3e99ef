// The stand of the tests of the page: the renderer that is tested, a browser, and screenshots.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { constants, setPriority, tmpdir } from "node:os";
import path from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

/** @import { ChildProcess } from "node:child_process" */
/** @import { Browser, Page } from "playwright-core" */
/** @import { Status } from "../page/types.js" */

export const ROOT = fileURLToPath(new URL("../../..", import.meta.url));
const TARGET = path.resolve(ROOT, process.env.CARGO_TARGET_DIR ?? "target");
export const BIDIR = process.env.BIDIR_COMMAND ?? path.join(TARGET, "release", "bidir");
const CHROMIUM = ["chromium", "chromium-browser", "google-chrome"].map((name) => `/usr/bin/${name}`).find((file) => existsSync(file));
const SHOTS = path.join(TARGET, "browser");

/** Why nothing can be tested here; null: it can. */
export const MISSING = CHROMIUM ? (existsSync(BIDIR) ? null : `${BIDIR} is not built`) : "Chromium is not installed";

/** The longest wait for a page, also on a slow machine. Unit: milliseconds. */
const PATIENCE = 300_000;

const FLAGS = [
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
];

export const WIDE = { width: 1280, height: 800 };
export const NARROW = { width: 390, height: 844 };

/** @returns {Promise<Browser>} */
export function launch() {
  mkdirSync(SHOTS, { recursive: true });
  return chromium.launch({ executablePath: CHROMIUM, args: FLAGS });
}

/** A renderer that serves its page, in a folder of its own. */
export class Renderer {
  /**
   * @param {ChildProcess} child
   * @param {string} url
   * @param {string} folder
   */
  constructor(child, url, folder) {
    this.child = child;
    this.url = url;
    this.folder = folder;
  }

  /**
   * Starts one, and waits for the address that it prints.
   * @param {string[]} args
   * @returns {Promise<Renderer>}
   */
  static start(args) {
    const folder = mkdtempSync(path.join(tmpdir(), "bidir-page-"));
    const child = spawn(BIDIR, args, { cwd: folder, stdio: ["ignore", "pipe", "pipe"] });
    // Tests wait for the browser, which would have to share all cores with the renderer.
    if (child.pid) setPriority(child.pid, constants.priority.PRIORITY_LOW);
    return new Promise((resolve, reject) => {
      let said = "";
      const hear = (/** @type {string} */ line) => {
        said += `${line}\n`;
        const url = line.match(/http:\/\/\S+/)?.[0];
        if (url) resolve(new Renderer(child, url, folder));
      };
      createInterface({ input: child.stdout }).on("line", hear);
      createInterface({ input: child.stderr }).on("line", hear);
      child.once("exit", (code) => reject(new Error(`bidir ${args.join(" ")} ends with ${code}: ${said}`)));
    });
  }

  /** @param {string} query */
  at(query) {
    return new URL(query, this.url).href;
  }

  /** @returns {Promise<Status>} */
  async status() {
    return (await fetch(this.at("/status"))).json();
  }

  /**
   * Waits for an expected state; while new lanes are made it has the lanes before.
   * @param {(status: Status) => boolean} isIt
   */
  async until(isIt) {
    const end = Date.now() + PATIENCE;
    for (;;) {
      const status = await this.status();
      if (status.state !== "preparing" && isIt(status)) return status;
      assert.ok(Date.now() < end, `this did not come: ${isIt}; it is ${status.state}, ${JSON.stringify(status.camera)}, ${status.lanes.map(({ generation, passes }) => `${generation}/${passes}`)}`);
      await sleep(100);
    }
  }

  /** @param {string} query */
  async bytes(query) {
    const answer = await fetch(this.at(query));
    assert.equal(answer.status, 200, query);
    return Buffer.from(await answer.arrayBuffer());
  }

  /** Ends it, and waits until it has. */
  async end() {
    const { child } = this;
    child.removeAllListeners("exit");
    const gone = new Promise((resolve) => child.once("exit", resolve));
    const isGone = child.exitCode !== null || child.signalCode !== null;
    child.kill("SIGKILL");
    if (!isGone) await gone;
    rmSync(this.folder, { recursive: true, force: true });
  }
}

/** @param {number} milliseconds */
export function sleep(milliseconds) {
  return new Promise((resolve) => setTimeout(resolve, milliseconds));
}

/**
 * A page of which nothing may be said on its console, and that asks nobody else for anything.
 * @param {Browser} browser
 * @param {string} url
 * @param {{width: number, height: number}} viewport
 */
export async function open(browser, url, viewport = WIDE) {
  const page = await browser.newPage({ viewport, acceptDownloads: true, hasTouch: viewport === NARROW });
  page.setDefaultTimeout(PATIENCE);
  /** @type {string[]} */
  const faults = [];
  page.on("pageerror", (error) => faults.push(`error: ${error.message}`));
  page.on("console", (message) => {
    // The driver's remarks on speed are no faults of the page.
    if (!message.text().includes("GPU stall due to ReadPixels")) faults.push(`console: ${message.text()}`);
  });
  const { host } = new URL(url);
  page.on("request", (request) => {
    const asked = new URL(request.url());
    if (asked.host !== host && !["data:", "blob:"].includes(asked.protocol)) faults.push(`asks ${request.url()}`);
  });
  page.on("websocket", (socket) => {
    if (new URL(socket.url()).host !== host) faults.push(`talks to ${socket.url()}`);
  });
  await page.goto(url);
  return { page, faults };
}

/**
 * Keeps what the page looks like, for people.
 * @param {Page} page
 * @param {string} name
 * @param {{fullPage?: boolean}} how
 */
export function keep(page, name, how = {}) {
  const size = page.viewportSize()?.width === NARROW.width ? "narrow" : "wide";
  return page.screenshot({ path: path.join(SHOTS, `${name}-${size}.png`), ...how });
}

/** @type {WeakMap<Browser, Promise<Page>>} Where images are decoded. */
const EYES = new WeakMap();

/**
 * The channels of a PNG, four for each pixel, as a browser sees them.
 * @param {Browser} browser
 * @param {Buffer} png
 */
export async function decode(browser, png) {
  const eye = EYES.get(browser) ?? browser.newPage();
  EYES.set(browser, eye);
  return (await eye).evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    if (!context) throw new Error("there is no canvas");
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    return { width: bitmap.width, height: bitmap.height, data: [...data] };
  }, png.toString("base64"));
}

/**
 * The mean distance of two images over all channels.
 * @param {{data: number[]}} a
 * @param {{data: number[]}} b
 */
export function difference(a, b) {
  return a.data.reduce((sum, value, i) => sum + Math.abs(value - b.data[i]), 0) / a.data.length;
}

/**
 * The brightness of an image.
 * @param {{data: number[]}} image
 */
export function brightness({ data }) {
  let sum = 0;
  for (let i = 0; i < data.length; i += 4) sum += data[i] + data[i + 1] + data[i + 2];
  return (4 * sum) / (3 * data.length);
}
