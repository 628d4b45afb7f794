// A kiosk before the real server: its views in turn, whole; no input moves it; it comes back also where session and storm are gone.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { setTimeout as sleep } from "node:timers/promises";
import { freePort, ROOT, startServer } from "../../tests/e2e/server_process.mjs";
import { throttledLink } from "../../tests/e2e/throttled_link.mjs";
import { rests, startDesktop } from "./desktop_process.mjs";
import { difference, eventually, pixelsLike, region } from "./pixels.mjs";
import { startDisplay } from "./xvfb.mjs";

const SIZE = { width: 640, height: 400 };
// Lists and different kinds of cameras: each must replace what the view before has said.
const VIEWS = [
  {
    camera: { orbit: { azimuthDeg: 45 } },
    fields: [{ hydrometeor: "HYDROMETEOR_ICE", visible: false }],
    lights: [{ azimuthDeg: 90, elevationDeg: 20 }],
    // An automatic one may take a step when more light has been traced, which changes the whole picture.
    display: { exposureEv: -0.5 },
  },
  { camera: { topDown: {} }, fields: [{ hydrometeor: "HYDROMETEOR_ICE", visible: true }] },
];

let folder;
let display;
let server;
let serverFlags;
let kiosk;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "thunderhead-kiosk-"));
  display = await startDisplay(SIZE.width, SIZE.height);
  serverFlags = { httpPort: await freePort(), grpcPort: await freePort() };
  server = await startServer(serverFlags);
  const files = VIEWS.map((view, at) => {
    const file = join(folder, `view_${at}.json`);
    writeFileSync(file, JSON.stringify(view));
    return file;
  });
  kiosk = startDesktop(display, serverFlags.grpcPort, ["--kiosk", "--view-seconds", "3", "--views", ...files]);
});

after(async () => {
  await kiosk?.stop();
  await server?.stop();
  await display?.stop();
  rmSync(folder, { recursive: true, force: true });
});

// That view's camera is in the picture.
const shows = (at) => (now) => now.view === at && now.camera === ["orbit", "top_down"][at] && now.shown_revision === now.revision;

// The corner has a warning.
const CORNER = { x: 0, y: SIZE.height - 60, width: SIZE.width, height: 60 };
const warns = () => pixelsLike(region(display.pixels(), CORNER), [255, 140, 122]) > 100;

test("every view is taken by the server, round after round", async () => {
  for (const at of [0, 1, 0, 1, 0]) {
    const { revision, problem, notice } = await kiosk.until(`view ${at}`, shows(at));
    assert.deepEqual({ problem, notice }, { problem: "", notice: "" });
    await kiosk.until("the next one", (now) => now.revision > revision || now.view !== at);
  }
});

test("a server that has lost its sessions and its storm is shown as it is now", async () => {
  const { storm, joined } = kiosk.status();
  await server.stop("SIGKILL");
  await kiosk.until("the loss", (now) => now.link !== "live");
  await sleep(500);
  server = await startServer({ ...serverFlags, data: `${ROOT}samples/supercell-500m.nc` });
  const back = await kiosk.until("the other storm", (now) => now.joined > joined && now.shown_revision > 0 && now.storm !== storm);
  assert.equal(back.storm, "supercell-500m");
  await kiosk.until("a view of it", (now) => now.link === "live" && now.camera !== "none");
});

test("a view stands until it is due, whatever is pressed, and comes at once in a new session", async () => {
  await kiosk.stop();
  const views = [0, 1].map((at) => join(folder, `view_${at}.json`));
  kiosk = startDesktop(display, serverFlags.grpcPort, ["--kiosk", "--view-seconds", "3600", "--views", ...views]);
  const isSeen = (now) => shows(0)(now) && Math.abs(now.azimuth_deg - 45) < 0.5;
  const { revision } = await kiosk.until("the view", (now) => isSeen(now) && rests(now));
  await sleep(4000);
  assert.equal(kiosk.status().revision, revision, "the view was sent again");
  // Traced light is in the picture, and adds little from now on.
  await kiosk.until("the measured error", (now) => now.error_measured && now.error < 0.5);
  let pictureBefore = display.pixels();
  const settles = async () => {
    const last = pictureBefore;
    await sleep(2000);
    pictureBefore = display.pixels();
    return difference(last, pictureBefore) < 0.01;
  };
  await eventually("the light settles", settles, { seconds: 90 });
  for (const key of ["Left", "Left", "x", "question", "comma"]) display.key(key);
  await display.drag({ x: 200, y: 200 }, { x: 400, y: 200 });
  display.xdotool("click", 4);
  await display.click(320, 380);
  const { revision: later, joined, azimuth_deg } = await kiosk.settled();
  assert.equal(later, revision, "input has changed the scene");
  assert.ok(Math.abs(azimuth_deg - 45) < 0.5, `it turned to ${azimuth_deg}`);
  // A panel would cover a third of the picture.
  const changed = difference(pictureBefore, display.pixels());
  assert.ok(changed < 0.05, `${changed} of the picture is another one`);
  await server.stop("SIGKILL");
  await kiosk.until("the loss", (now) => now.link !== "live");
  server = await startServer(serverFlags);
  await kiosk.until("the view in a new session", (now) => isSeen(now) && now.joined > joined);
});

test("a view that the server refuses says why", async () => {
  await kiosk.stop();
  const view = join(folder, "refused.json");
  writeFileSync(view, JSON.stringify({ camera: { orbit: { azimuthDeg: 45, elevationDeg: 500 } } }));
  kiosk = startDesktop(display, serverFlags.grpcPort, ["--kiosk", "--view-seconds", "3600", "--views", view]);
  const { notice } = await kiosk.until("the refusal", (now) => now.notice !== "");
  assert.match(notice, /elevation_deg/);
  await eventually("the wall says nothing", warns);
  display.screenshot("kiosk_refused");
});

test("a link that falls silent is a loss, which the wall tells and comes back from", async () => {
  await kiosk.stop();
  const link = await throttledLink({ port: serverFlags.grpcPort, kbitPerS: 100_000, roundTripMs: 2 });
  try {
    kiosk = startDesktop(display, link.port, ["--kiosk", "--view-seconds", "3600", "--views", join(folder, "view_0.json")]);
    const { joined } = await kiosk.until("the view", (now) => shows(0)(now) && rests(now));
    link.silence();
    await kiosk.until("the loss", (now) => now.link === "lost", 30_000);
    await eventually("the wall says nothing", warns);
    display.screenshot("kiosk_silent");
    link.heal();
    await kiosk.until("back", (now) => now.joined > joined && shows(0)(now) && now.link === "live");
    await eventually("the warning stays", () => !warns());
  } finally {
    await kiosk.stop();
    await link.close();
  }
});

test("with the viewers' key it shows its views' cameras to itself, without views what the presenter shows", async () => {
  const view = (at) => ["--view-seconds", "3600", "--views", join(folder, `view_${at}.json`)];
  const presenter = startDesktop(display, serverFlags.grpcPort, ["--kiosk", ...view(1)]);
  try {
    const { viewer_key, revision } = await presenter.until("the presenter's view", (now) => now.camera === "top_down" && rests(now));
    const key = ["--kiosk", "--key", viewer_key];
    kiosk = startDesktop(display, serverFlags.grpcPort, [...key, ...view(0)]);
    const own = await kiosk.until("the view", (now) => now.camera === "orbit" && Math.abs(now.azimuth_deg - 45) < 0.5);
    assert.deepEqual({ role: own.role, looks_around: own.looks_around }, { role: "viewer", looks_around: true });
    const { camera, revision: later } = await presenter.settled();
    assert.deepEqual({ camera, revision: later }, { camera: "top_down", revision }, "it has changed the presenter's scene");
    await kiosk.stop();
    kiosk = startDesktop(display, serverFlags.grpcPort, key);
    const followed = await kiosk.until("the presenter's view", (now) => now.camera === "top_down" && now.frames > 0);
    assert.equal(followed.looks_around, false);
  } finally {
    await presenter.stop();
  }
});
