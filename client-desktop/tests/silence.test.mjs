// Tests a kiosk whose link to the real server becomes silent. This test has its own file because it mostly waits. The
// client takes half a minute to distinguish silence from a slow server, and a kiosk's warning comes even later.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { freePort, startServer } from "../../tests/e2e/server_process.mjs";
import { throttledLink } from "../../tests/e2e/throttled_link.mjs";
import { rests, startDesktop } from "./desktop_process.mjs";
import { eventually, pixelsLike, region } from "./pixels.mjs";
import { startDisplay } from "./xvfb.mjs";

const SIZE = { width: 640, height: 400 };
const BAD = [255, 140, 122];

let folder;
let display;
let server;
let link;
let kiosk;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "thunderhead-silence-"));
  const view = join(folder, "view.json");
  writeFileSync(view, JSON.stringify({ camera: { orbit: { azimuthDeg: 45 } }, rendering: { preset: "PRESET_FAST" } }));
  display = await startDisplay(SIZE.width, SIZE.height);
  const flags = { httpPort: await freePort(), grpcPort: await freePort() };
  server = await startServer(flags);
  link = await throttledLink({ port: flags.grpcPort, kbitPerS: 100_000, roundTripMs: 2 });
  kiosk = startDesktop(display, link.port, ["--kiosk", "--view-seconds", "3600", "--views", view]);
});

after(async () => {
  await kiosk?.stop();
  await link?.close();
  await server?.stop();
  await display?.stop();
  rmSync(folder, { recursive: true, force: true });
});

// The area at the lower edge in which the kiosk shows a warning.
const CORNER = { x: 0, y: SIZE.height - 60, width: SIZE.width, height: 60 };
const warns = () => pixelsLike(region(display.pixels(), CORNER), BAD) > 100;

const showsView = (now) => Math.abs(now.azimuth_deg - 45) < 0.5 && rests(now);

test("a link that falls silent is a loss, which the wall tells and comes back from", async () => {
  const { joined, viewer_key } = await kiosk.until("the view", showsView);
  assert.ok(!warns());
  link.silence();
  await kiosk.until("the loss", (now) => now.link === "lost");
  await eventually("the wall says nothing", warns);
  display.screenshot("kiosk_silent");
  link.heal();
  const back = await kiosk.until("the return", (now) => now.joined > joined && showsView(now));
  assert.equal(back.viewer_key, viewer_key);
  await eventually("the warning stays", () => !warns());
});
