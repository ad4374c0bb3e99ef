// With `#selftest` at the end of the address the page uses its own viewer, and writes what came of it.

/** What is on the canvas, as a number that differs where pictures do. */
function fingerprint() {
  const canvas = byId("canvas", HTMLCanvasElement);
  const { data } = contextOf(canvas).getImageData(0, 0, canvas.width, canvas.height);
  return data.reduce((hash, byte) => Math.imul(hash ^ byte, 16777619), 2166136261);
}

/**
 * Presses a key on the picture, as a person does.
 * @param {string} key
 */
function press(key) {
  byId("canvas", HTMLCanvasElement).dispatchEvent(new KeyboardEvent("keydown", { key, cancelable: true }));
}

/**
 * Sets a control, as a person does.
 * @param {HTMLInputElement | HTMLSelectElement} control
 * @param {string} value
 */
function set(control, value) {
  control.value = value;
  control.dispatchEvent(new Event("input"));
}

/**
 * Steps of the viewer; each is true where the picture is as it should be.
 * @returns {Record<string, () => boolean>}
 */
function steps() {
  const changes = (/** @type {() => void} */ step) => {
    const before = fingerprint();
    step();
    return fingerprint() !== before;
  };
  const thereAndBack = (/** @type {() => void} */ there, /** @type {() => void} */ back) => {
    const before = fingerprint();
    return changes(there) && changes(back) && fingerprint() === before;
  };
  const layer = byId("layer", HTMLSelectElement);
  const exposure = byId("exposure", HTMLInputElement);
  const curve = byId("curve", HTMLSelectElement);
  return {
    "keys flip": () => thereAndBack(() => press("f"), () => press(" ")),
    "the button flips": () => {
      const button = byId("flip", HTMLButtonElement);
      return thereAndBack(() => button.click(), () => button.click());
    },
    "the picture is divided": () => thereAndBack(() => press("s"), () => press("s")),
    "exposure": () => thereAndBack(() => set(exposure, "2"), () => set(exposure, "0")),
    "tone": () => thereAndBack(() => set(curve, "linear"), () => set(curve, "srgb")),
    "relative error": () => thereAndBack(() => set(layer, "relative"), () => set(layer, "image")),
    "flip error": () => thereAndBack(() => set(layer, "flip"), () => set(layer, "image")),
    "zoom": () => thereAndBack(() => press("+"), () => press("-")),
    "pan": () => thereAndBack(() => press("ArrowLeft"), () => press("ArrowRight")),
    "digits choose": () => thereAndBack(() => press("2"), () => press("1")),
    "values of pixels": () => {
      const canvas = byId("canvas", HTMLCanvasElement);
      const { left, top, width, height } = canvas.getBoundingClientRect();
      const place = { clientX: left + width / 2, clientY: top + height / 2 };
      canvas.dispatchEvent(new PointerEvent("pointermove", place));
      return /reference( +[0-9.e-]+){3}/.test(byId("values", HTMLPreElement).textContent ?? "");
    },
    "scenes": () => {
      const scene = byId("scene", HTMLSelectElement);
      const choose = (/** @type {number} */ index) => {
        scene.selectedIndex = index;
        scene.dispatchEvent(new Event("change"));
      };
      return scene.length < 2 || thereAndBack(() => choose(1), () => choose(0));
    },
  };
}

/** Whether all contact sheets are there and can be seen. */
async function showsSheets() {
  const sheets = [...document.querySelectorAll("img")];
  await Promise.allSettled(sheets.map((sheet) => sheet.decode()));
  return sheets.every((sheet) => sheet.naturalWidth > 0 && sheet.width > 0 && sheet.alt !== "");
}

/** Tries to load an image, and tells whether the policy of the page refused to. */
function refusesRequests() {
  return new Promise((resolve) => {
    document.addEventListener("securitypolicyviolation", () => resolve(true), { once: true });
    const image = document.createElement("img");
    image.addEventListener("load", () => resolve(false));
    image.src = "no-such-image.png";
    setTimeout(() => resolve(false), 1000);
  });
}

/** Goes through all steps, and writes a line for each. */
async function selftest() {
  const lines = Object.entries(steps()).map(([name, step]) => `${step() ? "ok" : "FAILED"}: ${name}`);
  const loaded = performance.getEntriesByType("resource").length;
  lines.push(`${loaded === 0 ? "ok" : "FAILED"}: nothing was loaded`);
  lines.push(`${(await showsSheets()) ? "ok" : "FAILED"}: contact sheets are shown`);
  lines.push(`${(await refusesRequests()) ? "ok" : "FAILED"}: requests are refused`);
  const report = document.createElement("pre");
  report.id = "selftest";
  report.textContent = [...lines, "end"].join("\n");
  document.body.append(report);
}

if (viewer && location.hash === "#selftest") selftest();
