// The window's panels, pressed by real input before the real server; a browser as the other side of a session.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { setTimeout as sleep } from "node:timers/promises";
import { freePort, startServer } from "../../tests/e2e/server_process.mjs";
import { rests, startDesktop } from "./desktop_process.mjs";
import { difference, eventually, meanColor, region } from "./pixels.mjs";
import { startDisplay } from "./xvfb.mjs";

const SIZE = { width: 1280, height: 800 };
const WINDOW = ["--width", String(SIZE.width), "--height", String(SIZE.height), "--scale", "1"];

let display;
let server;
let serverFlags;
let desktop;

before(async () => {
  display = await startDisplay(SIZE.width, SIZE.height);
  serverFlags = { httpPort: await freePort(), grpcPort: await freePort() };
  server = await startServer(serverFlags);
  desktop = startDesktop(display, serverFlags.grpcPort, [...WINDOW, "--name", "Wall"]);
  await desktop.until("the first picture", rests);
});

after(async () => {
  await desktop?.stop();
  await server?.stop();
  await display?.stop();
});

// Presses, and waits for the picture of the scene that this makes.
async function change(what, press) {
  const { revision } = desktop.status();
  await press();
  const { problem, notice } = await desktop.until(what, (now) => rests(now) && now.revision > revision);
  assert.deepEqual({ problem, notice }, { problem: "", notice: "" });
}

test("false colours are picked where the picture shows them", async () => {
  const COLOR = { x: 120, y: 124, width: 14, height: 14 }; // of the first field
  const STORM = { x: 560, y: 330, width: 400, height: 200 };
  const shownColor = () => meanColor(region(display.pixels(), COLOR));
  display.key("f");
  await sleep(500);
  assert.ok(shownColor()[0] < 200, "a colour is offered that the picture does not show");
  display.key("k");
  await sleep(500);
  await change("false colours", () => display.click(127, 230));
  display.key("f");
  await eventually("the default, red, is not shown", () => shownColor()[0] > 240 && shownColor()[2] < 20);
  const before = region(display.pixels(), STORM);
  await display.click(127, 131);
  await sleep(500);
  display.screenshot("picker");
  // Blue on the picker's bar of hues.
  await change("a blue cloud", () => display.click(438, 360));
  display.key("Escape");
  await sleep(500);
  assert.ok(difference(before, region(display.pixels(), STORM)) > 0.02, "the cloud has the colour that it had");
  display.key("f");
  await eventually("the colour in the panel is not blue", () => shownColor()[0] < 20 && shownColor()[2] > 240);
  display.key("Escape");
  display.key("Escape");
});
