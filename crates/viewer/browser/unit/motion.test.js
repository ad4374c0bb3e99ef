// Many movements of a hand become few commands that say the same.

import assert from "node:assert/strict";
import test, { mock } from "node:test";
import { INTERVAL, Motions, Pilot, walk, walks } from "../../page/motion.js";

test("movements of a kind add up, and factors multiply", () => {
  const motions = new Motions();
  motions.add("orbit", { yaw: 0.1, pitch: 0 });
  motions.add("dolly", { factor: 2 });
  motions.add("orbit", { yaw: 0.25, pitch: -0.5 });
  motions.add("dolly", { factor: 0.25 });
  assert.deepEqual(motions.next(), ["orbit", { yaw: 0.35, pitch: -0.5 }]);
  assert.deepEqual(motions.next(), ["dolly", { factor: 0.5 }]);
  assert.equal(motions.next(), null);
});

test("keys walk along their axes, and opposite ones stand still", () => {
  assert.ok(walks("KeyW") && !walks("KeyX"));
  const step = walk(["KeyW", "KeyD"], 1);
  assert.ok(step && step.forward > 0 && step.right === step.forward && step.up === 0);
  assert.equal(walk(["KeyW", "KeyS"], 1), null);
  assert.equal(walk([], 1), null);
});

test("a pilot sends at most fifteen commands a second, and stops", () => {
  mock.timers.enable({ apis: ["setInterval"] });
  /** @type {[string, unknown][]} */
  const sent = [];
  const pilot = new Pilot((name, amounts) => sent.push([name, amounts]));
  for (let i = 0; i < 100; i++) {
    pilot.move("orbit", { yaw: 1, pitch: 0 });
    mock.timers.tick(10);
  }
  mock.timers.tick(1000);
  assert.ok(sent.length >= 10 && sent.length <= 16, `${sent.length} commands`);
  const turned = sent.reduce((sum, [, amounts]) => sum + /** @type {{yaw: number}} */ (amounts).yaw, 0);
  assert.equal(turned, 100);
  assert.equal(pilot.timer, null);
  mock.timers.reset();
});

test("a held key walks until it is let go", () => {
  mock.timers.enable({ apis: ["setInterval"] });
  let count = 0;
  const pilot = new Pilot(() => (count += 1));
  pilot.press("KeyW");
  mock.timers.tick(5 * INTERVAL + 1);
  assert.equal(count, 6);
  pilot.release("KeyW");
  mock.timers.tick(1000);
  assert.equal(count, 6);
  mock.timers.reset();
});

test("what waits when the camera goes elsewhere is not sent", () => {
  mock.timers.enable({ apis: ["setInterval"] });
  /** @type {string[]} */
  const sent = [];
  const pilot = new Pilot((name) => sent.push(name));
  pilot.move("orbit", { yaw: 1, pitch: 0 });
  pilot.move("pan", { right: 1, up: 0 });
  pilot.forget();
  mock.timers.tick(1000);
  assert.deepEqual(sent, ["orbit"]);
  mock.timers.reset();
});
