// Runs a kiosk for a long time and restarts its server now and then. The picture must come back automatically, and
// memory use must stay constant.
//   node kiosk_soak.mjs [--seconds 3600] [--restart-every 300]
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { freePort, startServer } from "../../tests/e2e/server_process.mjs";
import { startDesktop } from "./desktop_process.mjs";
import { startDisplay } from "./xvfb.mjs";

const { values } = parseArgs({
  options: { seconds: { type: "string", default: "3600" }, "restart-every": { type: "string", default: "300" } },
});
const seconds = Number(values.seconds);
const restartEvery = Number(values["restart-every"]);
const VIEWS = ["west.json", "above.json"].map((name) => fileURLToPath(new URL(`../../deploy/views/${name}`, import.meta.url)));
// Growth of the kiosk's resident memory over the second half of the run that counts as a leak, in bytes. A kiosk that
// leaked one picture of 960 x 540 per view would exceed it.
const MAX_GROWTH = 2e6;

const display = await startDisplay(960, 540);
const state = mkdtempSync(join(tmpdir(), "thunderhead-state-"));
const flags = { httpPort: await freePort(), grpcPort: await freePort(), state };
let server = await startServer(flags);
const kiosk = startDesktop(display, flags.grpcPort, ["--kiosk", "--view-seconds", "5", "--views", ...VIEWS]);
let failures = 0;
let restarts = 0;
try {
  await kiosk.until("the first picture", (now) => now.frames > 0);
  const lines = []; // all status lines so far, because the status file keeps only the last half hour
  const start = Date.now();
  let restartedAt = start;
  while (Date.now() - start < seconds * 1000) {
    await sleep(1000);
    const now = kiosk.status();
    if (now.t_s !== undefined) lines.push(now);
    if (kiosk.child.exitCode !== null) throw new Error(`the kiosk ended:\n${kiosk.said()}`);
    if (Date.now() - restartedAt < restartEvery * 1000) continue;
    restartedAt = Date.now();
    restarts += 1;
    const { joined } = kiosk.status();
    await server.stop("SIGKILL");
    await kiosk.until("the loss", (now) => now.link !== "live");
    server = await startServer(flags);
    await kiosk.until("the return", (now) => now.link === "live" && now.joined > joined);
    const { frames } = kiosk.status();
    await kiosk.until("a new picture", (now) => now.frames > frames);
  }
  const views = new Set(lines.map((line) => line.view).filter((view) => view >= 0));
  const resident = lines.map((line) => line.resident_bytes);
  const peak = (from, to) => Math.max(...resident.slice(Math.floor(from * resident.length), Math.ceil(to * resident.length)));
  const [middle, end] = [peak(0.4, 0.5), peak(0.9, 1)];
  const report = { seconds, restarts, frames: lines.at(-1).frames, views: views.size, resident_middle: middle, resident_end: end };
  console.log(JSON.stringify(report));
  const minutes = Array.from({ length: 12 }, (_, i) => (peak(i / 12, (i + 1) / 12) / 1e6).toFixed(1));
  console.log(`largest resident size in each twelfth, MB: ${minutes.join(" ")}`);
  if (end - middle > MAX_GROWTH) throw new Error(`memory grew by ${((end - middle) / 1e6).toFixed(1)} MB`);
  if (views.size < VIEWS.length) throw new Error("not every view was shown");
} catch (error) {
  failures = 1;
  console.error(String(error));
} finally {
  await kiosk.stop();
  await server.stop();
  await display.stop();
  rmSync(state, { recursive: true, force: true });
}
process.exit(failures);
