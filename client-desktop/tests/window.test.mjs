// Tests the native client in a window of Xvfb, with real input events, against the real server. A browser is the other
// client of the session.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { canvasData, changing, dragBetween, launchBrowser, openTool, rested, until } from "../../tests/e2e/driver.mjs";
import { freePort, startServer } from "../../tests/e2e/server_process.mjs";
import { drawn, ready, rests, startDesktop } from "./desktop_process.mjs";
import { accentIn, brightness, difference, region } from "./pixels.mjs";
import { startDisplay } from "./xvfb.mjs";

const SIZE = { width: 1280, height: 800 };
const WINDOW = ["--width", String(SIZE.width), "--height", String(SIZE.height), "--scale", "1"];
// The bar above the time line that shows the person in control.
const SESSION_BAR = { x: 300, y: 660, width: 680, height: 36 };
const MIDDLE = { x: 700, y: 330 };

let display;
let server;
let serverFlags;
let state;
let desktop;

const azimuthOf = async (page) => Number((await canvasData(page)).azimuth);
const apart = (a, b) => Math.abs(((a - b + 540) % 360) - 180);

before(async () => {
  display = await startDisplay(SIZE.width, SIZE.height);
  state = mkdtempSync(join(tmpdir(), "thunderhead-state-"));
  serverFlags = { httpPort: await freePort(), grpcPort: await freePort(), state };
  server = await startServer(serverFlags);
  desktop = startDesktop(display, serverFlags.grpcPort, [...WINDOW, "--name", "Wall"]);
  // The first picture may be smaller than the window.
  const fills = (now) => ready(now) && now.width_px === SIZE.width && now.height_px === SIZE.height;
  await desktop.until("a picture of the window's size", fills);
});

after(async () => {
  await desktop?.stop();
  await server?.stop();
  await display?.stop();
  rmSync(state, { recursive: true, force: true });
});

test("it opens a session of its own, steers it and fills the window with a storm", async () => {
  const status = desktop.status();
  assert.equal(status.role, "presenter");
  assert.equal(status.steers, true);
  assert.ok(brightness(display.pixels()) > 25, "the window is black");
  display.screenshot("plain");
  await desktop.chooseFast();
});

test("a drag turns the camera, the wheel comes nearer, keys do the same", async () => {
  const before = desktop.status().azimuth_deg;
  const pictureBefore = display.pixels();
  await desktop.drag(MIDDLE, { x: MIDDLE.x + 200, y: MIDDLE.y });
  // A drag over 200 pixels, a quarter of the window's height, turns the camera by a quarter of 180 degrees.
  const dragged = await desktop.until("a turned picture", (now) => rests(now) && apart(now.azimuth_deg, before + 45) < 1);
  assert.ok(difference(pictureBefore, display.pixels()) > 0.05, "the picture is the same");
  // Edits that follow one another within a short time would be undone together.
  await desktop.until("the end of the drag's step", (now) => !now.undo_step_open);
  await desktop.key("Right");
  await desktop.until("turned by a key", (now) => rests(now) && apart(now.azimuth_deg, dragged.azimuth_deg + 3) < 0.5);
  const { revision } = await desktop.until("the end of the key's step", (now) => !now.undo_step_open);
  await desktop.wheel();
  await desktop.until("a nearer picture", (now) => rests(now) && now.revision > revision);
  await desktop.key("ctrl+z", "ctrl+z");
  await desktop.until("undone", (now) => rests(now) && apart(now.azimuth_deg, dragged.azimuth_deg) < 0.5);
});

test("times are stepped and played by keys", async () => {
  const { time_index: last } = desktop.status();
  await desktop.key("comma");
  await desktop.until("the time before", (now) => rests(now) && now.time_index === last - 1);
  await desktop.key("space");
  await desktop.until("another time", (now) => now.time_index !== last - 1);
  await desktop.key("space");
  // Times that playback shows are not recorded as steps of the undo history.
  await desktop.key("ctrl+z");
  await desktop.until("the time before the step", (now) => rests(now) && now.time_index === last);
});

const PANELS = { camera: "m", time: "t", light: "l", look: "k", fields: "f", marks: "d" };
const RIGHT = { storms: "o", people: "h", figures: "i", settings: "x", keys: "question" };

// Position of the panel title on each side.
const TITLE = { left: { x: 110, y: 82, width: 200, height: 24 }, right: { x: 876, y: 82, width: 150, height: 24 } };

test("every tool and panel opens by its key and closes by Escape", async () => {
  for (const [side, panels] of Object.entries({ left: PANELS, right: RIGHT })) {
    for (const [name, key] of Object.entries(panels)) {
      const title = () => region(display.pixels(), TITLE[side]);
      const before = title();
      const { tool, panel } = await desktop.key(key);
      assert.deepEqual({ tool, panel }, { tool: "", panel: "", [side === "left" ? "tool" : "panel"]: name });
      const open = title();
      assert.ok(difference(before, open) > 0.08, `${name} does not open`);
      display.screenshot(name);
      const closed = await desktop.key("Escape");
      assert.deepEqual({ tool: closed.tool, panel: closed.panel }, { tool: "", panel: "" });
      assert.ok(difference(open, title()) > 0.08, `${name} does not close`);
    }
  }
});

test("a number that is typed and left by Tab counts", async () => {
  assert.equal((await desktop.key("m")).tool, "camera");
  // This clicks the field next to "Seen from". All input arrives at once, as on a machine that stalls.
  const { typing } = await desktop.input({ at: { x: 366, y: 214 }, buttons: 2, keys: 4 }, () => {
    desktop.child.kill("SIGSTOP");
    display.xdotool("mousemove", 366, 214, "click", 1, "key", "ctrl+a", "type", "--delay", 20, "123");
    desktop.child.kill("SIGCONT");
  });
  assert.ok(typing, "the field has not the keyboard");
  display.screenshot("typing");
  await desktop.key("Tab");
  await desktop.until("the typed azimuth", (now) => rests(now) && apart(now.azimuth_deg, 123) < 0.5);
  await desktop.key("Escape", "Escape");
});

test("a browser joins as a viewer and follows", async () => {
  const browser = await launchBrowser();
  try {
    const page = await browser.newPage({ viewport: { width: 900, height: 560 } });
    await page.goto(`${server.url.replace(/\/$/, "")}/?session=${desktop.status().viewer_key}`);
    await rested(page);
    await desktop.until("two people", (now) => now.people === 2);
    const before = desktop.status().azimuth_deg;
    await desktop.drag(MIDDLE, { x: MIDDLE.x - 100, y: MIDDLE.y });
    // The test waits for the final angle, because pictures during the drag may also be complete.
    const turned = (now) => rests(now) && apart(now.azimuth_deg, before - 22.5) < 0.5;
    const { azimuth_deg } = await desktop.until("a turned picture", turned);
    await until("the browser follows", async () => apart(await azimuthOf(page), azimuth_deg) < 0.5);

    // The browser sees a line drawn in the window, and the window sees a line drawn in the browser.
    await desktop.key("d");
    // The pen is the second of three segments below the title.
    await desktop.click(265, 128);
    await desktop.drag({ x: 640, y: 380 }, { x: 820, y: 420 });
    await desktop.until("a mark", (now) => now.marks === 1);
    const marksInBrowser = () => page.getByTestId("mark").count();
    await until("the mark in the browser", async () => (await marksInBrowser()) === 1);
    display.screenshot("mark");
    await desktop.key("Escape", "Escape");

    // The browser asks to steer, gets control in the window, and the window follows.
    await page.getByTestId("ask-control").click();
    await desktop.until("a request", (now) => now.asking === 1 && drawn(now));
    display.screenshot("asked");
    const give = accentIn(display.pixels(), SESSION_BAR);
    await desktop.click(give.x, give.y);
    await desktop.until("gave control", (now) => !now.steers);
    const turnedBefore = desktop.status().azimuth_deg;
    await dragBetween(page, { x: 620, y: 300 }, { x: 720, y: 300 });
    await desktop.until("the window follows the browser", (now) => apart(now.azimuth_deg, turnedBefore) > 5);
    await openTool(page, "marks");
    await page.getByTestId("tool-pen").click();
    await dragBetween(page, { x: 500, y: 300 }, { x: 640, y: 330 });
    await desktop.until("the browser's mark", (now) => now.marks === 2);
    await page.getByTestId("tool-pointer").click();
    await page.mouse.move(600, 320);
    await desktop.until("the browser's pointer", (now) => now.pointers === 1);
    display.screenshot("browsers_pointer");
    await page.keyboard.press("Escape");
    await page.keyboard.press("Escape");
    await desktop.until("the pointer put away", (now) => now.pointers === 0);
  } finally {
    await browser.close();
  }
  await desktop.until("alone again", (now) => now.people === 1 && drawn(now));
});

test("--turn turns the camera by itself", async () => {
  const other = await startDisplay(640, 400);
  const turning = startDesktop(other, serverFlags.grpcPort, ["--width", "640", "--height", "400", "--scale", "1", "--turn", "30"]);
  try {
    const { azimuth_deg, frames } = await turning.until("a picture", (now) => now.frames > 0 && now.camera === "orbit");
    const turned = (now) => now.frames > frames && apart(now.azimuth_deg, azimuth_deg) > 3;
    await turning.until("a turned picture", turned);
  } finally {
    await turning.stop();
    await other.stop();
  }
});

test("the server is killed and restarted: the same session comes back", async () => {
  // The browser had control, and no one has it now. The window's button is "Take control".
  await desktop.click(735, 677);
  const { joined, ...before } = await desktop.until("control", (now) => now.steers);
  await server.stop("SIGKILL");
  await desktop.until("a lost connection", (now) => now.link === "lost" && drawn(now));
  display.screenshot("lost");
  server = await startServer(serverFlags);
  const back = await desktop.until("back", (now) => rests(now) && now.joined > joined);
  const session = ({ viewer_key, role, steers, storm, time_index, camera, marks }) => {
    return { viewer_key, role, steers, storm, time_index, camera, marks };
  };
  assert.deepEqual(session(back), session(before));
  assert.ok(apart(back.azimuth_deg, before.azimuth_deg) < 0.05, `${before.azimuth_deg} became ${back.azimuth_deg}`);
});

test("a browser presents, the window views, looks around and comes back", async () => {
  const browser = await launchBrowser();
  let viewer;
  try {
    const page = await browser.newPage({ viewport: { width: 900, height: 560 } });
    await page.goto(server.url);
    await rested(page);
    await until("a session in the address", async () => page.url().includes("session="));
    const key = new URL(page.url()).searchParams.get("session");
    await desktop.stop();
    viewer = startDesktop(display, serverFlags.grpcPort, [...WINDOW, "--key", key]);
    desktop = viewer;
    await viewer.until("the presenter's picture", rests);
    assert.equal(viewer.status().role, "viewer");
    assert.equal(viewer.status().steers, false);
    display.screenshot("viewer");
    await changing(() => dragBetween(page, { x: 620, y: 300 }, { x: 720, y: 300 }), page);
    const azimuth = await azimuthOf(page);
    await viewer.until("it follows", (now) => apart(now.azimuth_deg, azimuth) < 0.5);
    await viewer.drag(MIDDLE, { x: MIDDLE.x + 150, y: MIDDLE.y });
    const around = (now) => now.looks_around && apart(now.azimuth_deg, azimuth) > 10 && drawn(now);
    await viewer.until("it looks around", around);
    assert.ok(apart(await azimuthOf(page), azimuth) < 0.5, "the presenter's view moved");
    display.screenshot("looking_around");
    const back = accentIn(display.pixels(), SESSION_BAR);
    await viewer.click(back.x, back.y);
    await viewer.until("back with the presenter", (now) => !now.looks_around && apart(now.azimuth_deg, azimuth) < 0.5);
  } finally {
    await browser.close();
  }
});
