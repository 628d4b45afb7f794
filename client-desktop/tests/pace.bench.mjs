// Prints the cost of a 1280 x 720 picture in the window while the camera turns. The window uses software GL. The fake
// server draws nothing (tests/service/fake_server.cc), so that pictures arrive as fast as the window takes them.
// Processor time is measured instead of frame rate, because the machine may be busy with other work.
//   node pace.bench.mjs
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { ROOT } from "../../tests/e2e/server_process.mjs";
import { startDesktop } from "./desktop_process.mjs";
import { startDisplay } from "./xvfb.mjs";

const FAKE_SERVER = process.env.THUNDERHEAD_FAKE_SERVER ?? `${ROOT}build/release/bin/fake_server`;
const SIZE = { width: 1280, height: 720 };
const WINDOW = ["--width", String(SIZE.width), "--height", String(SIZE.height), "--scale", "1"];
const PICTURES = 30;
const STRETCHES = 5;

if (!existsSync(FAKE_SERVER)) throw new Error(`no program at ${FAKE_SERVER}; run ninja -C build/release fake_server`);
const server = spawn(FAKE_SERVER, ["0"], { stdio: ["ignore", "pipe", "inherit"] });
const port = await new Promise((resolve, reject) => {
  server.once("error", reject);
  server.once("exit", (code) => reject(new Error(`${FAKE_SERVER} exited with ${code}`)));
  server.stdout.once("data", (text) => resolve(Number(/port (\d+)/.exec(text)[1])));
});
const display = await startDisplay(SIZE.width, SIZE.height);
const desktop = startDesktop(display, port, [...WINDOW, "--turn", "30"]);
try {
  let from = await desktop.until("pictures", (now) => now.frames >= PICTURES);
  assert.deepEqual([from.width_px, from.height_px], [SIZE.width, SIZE.height]);
  const costsMs = [];
  while (costsMs.length < STRETCHES) {
    const { frames, processor_s } = from;
    from = await desktop.until("more pictures", (now) => now.frames >= frames + PICTURES);
    costsMs.push((1000 * (from.processor_s - processor_s)) / (from.frames - frames));
  }
  // The least measured time is the best estimate, because other programs can only increase it. If a picture costs at
  // most 33 ms, one core is enough for 30 pictures a second.
  console.log(`figure: processor time of a picture in the window, least of ${STRETCHES}: ${Math.min(...costsMs).toFixed(1)} ms`);
  console.log(`figure: processor time of a picture in the window, most of ${STRETCHES}: ${Math.max(...costsMs).toFixed(1)} ms`);
} finally {
  await desktop.stop();
  await display.stop();
  server.kill();
}
