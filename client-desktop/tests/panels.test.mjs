// Tests the window's panels by real input against the real server. A browser is the other client of the session.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launchBrowser, rested, until } from "../../tests/e2e/driver.mjs";
import { freePort, startServer } from "../../tests/e2e/server_process.mjs";
import { drawn, HANG_LIMIT_MS, ready, rests, startDesktop } from "./desktop_process.mjs";
import { accentIn, difference, eventually, meanColor, pixelsLike, region } from "./pixels.mjs";
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
  await desktop.until("the first picture", ready);
  await desktop.chooseFast();
});

after(async () => {
  await desktop?.stop();
  await server?.stop();
  await display?.stop();
});

// Presses a control, and waits for the picture of the changed scene.
async function change(what, press) {
  const { revision } = desktop.status();
  await press();
  const { problem, notice } = await desktop.until(what, (now) => rests(now) && now.revision > revision);
  assert.deepEqual({ problem, notice }, { problem: "", notice: "" });
}

test("false colours are picked where the picture shows them", async () => {
  const COLOR = { x: 120, y: 124, width: 14, height: 14 }; // button of the first field
  const STORM = { x: 560, y: 330, width: 400, height: 200 };
  const shownColor = () => meanColor(region(display.pixels(), COLOR));
  await desktop.key("f");
  assert.ok(shownColor()[0] < 200, "a colour is offered that the picture does not show");
  await desktop.key("k");
  await change("false colours", () => desktop.click(127, 230));
  await desktop.key("f");
  await eventually("the default, orange, is not shown", () => shownColor()[0] > 215 && shownColor()[2] < 20);
  const before = region(display.pixels(), STORM);
  await desktop.click(127, 131);
  display.screenshot("picker");
  // This point is blue on the picker's hue bar.
  await change("a blue cloud", () => desktop.click(438, 360));
  await desktop.key("Escape");
  assert.ok(difference(before, region(display.pixels(), STORM)) > 0.02, "the cloud has the colour that it had");
  await desktop.key("f");
  await eventually("the colour in the panel is not blue", () => shownColor()[0] < 20 && shownColor()[2] > 215);
  await desktop.key("Escape", "Escape");
});

// The bar above the time line that shows the person in control.
const SESSION_BAR = { x: 300, y: 660, width: 680, height: 36 };

test("rules, control and the pointer reach a viewer's page", async () => {
  const browser = await launchBrowser();
  try {
    const page = await browser.newPage({ viewport: { width: 900, height: 560 } });
    await page.goto(`${server.url.replace(/\/$/, "")}/?session=${desktop.status().viewer_key}`);
    await rested(page);
    await desktop.until("two people", (now) => now.people === 2);
    const ask = page.getByTestId("ask-control");

    await desktop.key("h");
    // The panel lists the two people, and the rules below them. This place has the check mark of the first rule.
    const mark = () => pixelsLike(region(display.pixels(), { x: 884, y: 272, width: 24, height: 24 }), [255, 209, 107]);
    await eventually("the rules are not shown", () => mark() > 20);
    display.screenshot("rules");
    // This click is on the rule that locks control.
    await desktop.click(895, 318);
    await until("control is locked on the page", () => ask.isDisabled(), HANG_LIMIT_MS);
    await desktop.click(895, 318);
    await until("control is free on the page", () => ask.isEnabled(), HANG_LIMIT_MS);
    await desktop.key("Escape");

    await ask.click();
    await desktop.until("a request", (now) => now.asking === 1 && drawn(now));
    // The button "No" is to the right of the button that gives control.
    const refused = accentIn(display.pixels(), SESSION_BAR);
    await desktop.click(refused.right + 24, refused.y);
    await desktop.until("the request refused", (now) => now.asking === 0 && now.steers);
    await until("the page may ask again", () => ask.isEnabled(), HANG_LIMIT_MS);

    // The window gives control without a request, because a refused viewer must wait before asking again.
    await desktop.key("h");
    await desktop.click(1186, 224);
    await desktop.until("control given", (now) => !now.steers);
    await desktop.key("Escape");
    const taken = accentIn(display.pixels(), SESSION_BAR);
    await desktop.click(taken.x, taken.y);
    await desktop.until("control taken back", (now) => now.steers);

    await desktop.key("d");
    // The pointer is the last of three segments.
    await desktop.click(366, 128);
    await desktop.move(700, 300);
    await desktop.move(705, 310);
    const pointers = () => page.getByTestId("pointer").count();
    await until("the window's pointer on the page", async () => (await pointers()) === 1, HANG_LIMIT_MS);
    await desktop.key("Escape", "Escape");
    await until("the pointer put away", async () => (await pointers()) === 0, HANG_LIMIT_MS);
  } finally {
    await browser.close();
  }
});

test("a notice lies beside an open panel", async () => {
  const PANEL = { x: 868, y: 74, width: 400, height: 400 };
  const BESIDE = { x: 420, y: 74, width: 436, height: 120 };
  const BAD = [255, 140, 122];
  const notices = (area) => pixelsLike(region(display.pixels(), area), BAD);
  await desktop.key("h");
  assert.equal(notices(BESIDE), 0);
  await server.stop("SIGKILL");
  await desktop.until("the loss", (now) => now.link === "lost");
  await eventually("no notice beside the panel", () => notices(BESIDE) > 100);
  display.screenshot("notice_beside_panel");
  assert.equal(notices(PANEL), 0, "the notice lies over the panel");
  await desktop.key("Escape");
  server = await startServer(serverFlags);
  await desktop.until("back", (now) => now.link === "live");
});

test("at a scale of 2 panels lie beside each other, and presses hit", async () => {
  await desktop.stop();
  const large = await startDisplay(1600, 1000);
  try {
    desktop = startDesktop(large, serverFlags.grpcPort, ["--width", "1600", "--height", "1000", "--scale", "2"]);
    await desktop.until("the first picture", ready);
    // This opens "Look" on the rail, then switches its second check box, then opens the people panel.
    await desktop.click(2 * 50, 2 * 245);
    const { revision } = desktop.status();
    await desktop.click(2 * 127, 2 * 230);
    await desktop.until("false colours", (now) => rests(now) && now.revision > revision);
    await desktop.key("h");
    large.screenshot("scale_2");
    // The panel begins with its margin to the right of the tool. The space between them must be empty.
    const gap = { x: 2 * (100 + 306), y: 2 * 74, width: 2 * 10, height: 2 * 200 };
    assert.ok(pixelsLike(region(large.pixels(), gap), [255, 255, 255], 60) < 40, "text lies between the panels");
    const before = desktop.status();
    const after = await desktop.drag({ x: 900, y: 500 }, { x: 1000, y: 500 });
    assert.equal(after.edits, before.edits, "a drag over the panel changed the scene or turned the camera");
  } finally {
    await desktop.stop();
    await large.stop();
  }
});

const sized = (width, height) => (now) => rests(now) && now.width_px === width && now.height_px === height;
const SMALL = ["--width", "800", "--height", "500", "--scale", "1"];

test("full screen has the display's size", async () => {
  desktop = startDesktop(display, serverFlags.grpcPort, [...SMALL, "--full-screen"]);
  await desktop.until("a picture of the display's size", sized(SIZE.width, SIZE.height));
  const geometry = () => /Geometry: (\S+)/.exec(display.xdotool("search", "--name", "Thunderhead", "getwindowgeometry"))[1];
  assert.equal(geometry(), `${SIZE.width}x${SIZE.height}`);
  await desktop.stop();
  desktop = startDesktop(display, serverFlags.grpcPort, SMALL);
  await desktop.until("a picture of the window's size", sized(800, 500));
  assert.equal(geometry(), "800x500");
  await desktop.stop();
});

test("W makes the window full screen, and a window again", async () => {
  const managed = await startDisplay(SIZE.width, SIZE.height, { managed: true });
  try {
    desktop = startDesktop(managed, serverFlags.grpcPort, SMALL);
    await desktop.until("a picture of the window's size", sized(800, 500));
    // Keys go to the window below the pointer.
    managed.xdotool("mousemove", 400, 300);
    managed.xdotool("key", "w");
    await desktop.until("a picture of the display's size", sized(SIZE.width, SIZE.height));
    managed.screenshot("full_screen_by_key");
    managed.xdotool("key", "w");
    await desktop.until("a picture of the window's size again", sized(800, 500));
  } finally {
    await desktop.stop();
    await managed.stop();
  }
});

test("without --scale texts are as large as the monitor is fine", async () => {
  const fine = await startDisplay(1600, 1000, { dpi: 192 });
  try {
    desktop = startDesktop(fine, serverFlags.grpcPort, ["--width", "1600", "--height", "1000"]);
    const { scale } = await desktop.until("the first picture", ready);
    assert.equal(scale, 2);
    // This is the position of "Look" on the rail at that scale.
    const TITLE = { x: 2 * 110, y: 2 * 82, width: 2 * 60, height: 2 * 24 };
    const before = region(fine.pixels(), TITLE);
    await desktop.click(2 * 50, 2 * 245);
    await eventually("no panel at twice the place", () => difference(before, region(fine.pixels(), TITLE)) > 0.08);
    fine.screenshot("scale_of_monitor");
  } finally {
    await desktop.stop();
    await fine.stop();
  }
});

// Position of "Ask to steer" in a viewer's window of 640 x 400.
const ASK = { x: 404, y: 276 };
// Position of "and 2 more" in the presenter's window of 800 x 500.
const MORE = [322, 376];
const ACCENT = [255, 209, 107];

test("several who ask to steer are answered one by one, in a small window too", async () => {
  const NAMES = ["Aurelia of the long corridor on the second floor", "Ben", "Cleo", "Dora", "Emil"];
  const shows = (width, height) => ["--width", String(width), "--height", String(height), "--scale", "1"];
  const small = await startDisplay(800, 500);
  const viewers = [];
  try {
    desktop = startDesktop(small, serverFlags.grpcPort, [...shows(800, 500), "--name", "Wall"]);
    const { viewer_key } = await desktop.until("the first picture", ready);
    for (const name of NAMES) {
      const viewer = await startDisplay(640, 400);
      const flags = ["--key", viewer_key, "--name", name, ...shows(640, 400)];
      const window = startDesktop(viewer, serverFlags.grpcPort, flags);
      viewers.push({ viewer, window });
      await window.until(`${name} there`, (now) => ready(now) && now.people === viewers.length + 1);
      await window.click(ASK.x, ASK.y);
      await desktop.until(`${name} asking`, (now) => now.asking === viewers.length);
    }
    await desktop.until("all who ask, drawn", drawn);
    small.screenshot("several_ask");
    const rail = { x: 12, y: 250, width: 76, height: 110 };
    assert.equal(pixelsLike(region(small.pixels(), rail), ACCENT), 0, "a button lies over the tools");
    // People who do not fit into the bar are listed in the people panel.
    await desktop.click(...MORE);
    small.screenshot("several_ask_and_people");
    const panel = { x: 418, y: 74, width: 370, height: 326 };
    assert.ok(pixelsLike(region(small.pixels(), panel), [255, 255, 255], 40) > 500, "the people are not shown");
    assert.equal(pixelsLike(region(small.pixels(), panel), ACCENT), 0, "the bar lies over the people");
  } finally {
    for (const { viewer, window } of viewers) {
      await window.stop();
      await viewer.stop();
    }
    await desktop.stop();
    await small.stop();
  }
});
