// Tests a kiosk against the real server. It shows its complete views in turn, and no input moves it. It also recovers
// after its session and storm were lost.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { freePort, ROOT, startServer } from "../../tests/e2e/server_process.mjs";
import { complete, rests, startDesktop } from "./desktop_process.mjs";
import { difference, eventually, pixelsLike, region } from "./pixels.mjs";
import { startDisplay } from "./xvfb.mjs";

const SIZE = { width: 640, height: 400 };
const BAD = [255, 140, 122];
// The views have lists and different kinds of cameras. Each view must replace what the previous view set.
const VIEWS = [
  {
    camera: { orbit: { azimuthDeg: 45 } },
    fields: [{ hydrometeor: "HYDROMETEOR_ICE", visible: false }],
    lights: [{ azimuthDeg: 90, elevationDeg: 20 }],
    // No light is traced and the exposure is fixed, so that the picture does not change after it is complete.
    rendering: { preset: "PRESET_FAST" },
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
  kiosk = startDesktop(display, serverFlags.grpcPort, ["--kiosk", "--view-seconds", "1", "--views", ...files]);
});

after(async () => {
  await kiosk?.stop();
  await server?.stop();
  await display?.stop();
  rmSync(folder, { recursive: true, force: true });
});

// Returns a condition on the status: the picture shows the view with index `at`, with this view's kind of camera.
const shows = (at) => (now) => now.view === at && now.camera === ["orbit", "top_down"][at] && now.shown_revision === now.revision;

// The area at the lower edge in which the kiosk shows a warning.
const CORNER = { x: 0, y: SIZE.height - 60, width: SIZE.width, height: 60 };
const warns = () => pixelsLike(region(display.pixels(), CORNER), BAD) > 100;

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
  await kiosk.until("the loss", (now) => now.link === "lost");
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
  const { edits } = await kiosk.until("the complete picture of the view", (now) => isSeen(now) && complete(now));
  assert.equal(edits, 1, "the view was sent again");
  const pictureBefore = display.pixels();
  await kiosk.key("Left", "Left", "x", "question", "comma");
  await kiosk.drag({ x: 200, y: 200 }, { x: 400, y: 200 });
  await kiosk.wheel();
  const { joined, ...now } = await kiosk.click(320, 380);
  assert.deepEqual({ edits: now.edits, tool: now.tool, panel: now.panel }, { edits: 1, tool: "", panel: "" }, "input was taken");
  assert.ok(Math.abs(now.azimuth_deg - 45) < 0.5, `it turned to ${now.azimuth_deg}`);
  // An open panel would change a third of the picture, so a small difference shows that no panel has opened.
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

test("with the viewers' key it shows its views' cameras to itself, without views what the presenter shows", async () => {
  const view = (at) => ["--view-seconds", "3600", "--views", join(folder, `view_${at}.json`)];
  const presenter = startDesktop(display, serverFlags.grpcPort, ["--kiosk", ...view(1)]);
  try {
    const { viewer_key, revision } = await presenter.until("the presenter's view", (now) => now.camera === "top_down" && rests(now));
    const key = ["--kiosk", "--key", viewer_key];
    kiosk = startDesktop(display, serverFlags.grpcPort, [...key, ...view(0)]);
    const own = await kiosk.until("the view", (now) => now.camera === "orbit" && Math.abs(now.azimuth_deg - 45) < 0.5);
    assert.deepEqual({ role: own.role, looks_around: own.looks_around }, { role: "viewer", looks_around: true });
    await kiosk.stop();
    // The server reports that the kiosk has left after all of the kiosk's changes, so a change would be visible here.
    const { camera, revision: later } = await presenter.until("alone again", (now) => now.people === 1);
    assert.deepEqual({ camera, revision: later }, { camera: "top_down", revision }, "it has changed the presenter's scene");
    kiosk = startDesktop(display, serverFlags.grpcPort, key);
    const followed = await kiosk.until("the presenter's view", (now) => now.camera === "top_down" && now.frames > 0);
    assert.equal(followed.looks_around, false);
  } finally {
    await presenter.stop();
  }
});
