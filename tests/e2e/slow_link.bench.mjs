// Measures the page on a slow link while its camera turns: frames per second and latency, from its readout. The latency
// should not grow, and there should be 8 frames/s overall. There are fewer in the first seconds, while the server
// estimates the link.
//   node slow_link.bench.mjs [seconds] [kbit/s] [round trip in ms]
import { setTimeout } from "node:timers/promises";
import { canvasData, launchBrowser, rested } from "./driver.mjs";
import { freePort, startServer } from "./server_process.mjs";
import { throttledLink } from "./throttled_link.mjs";

const [seconds, kbitPerS, roundTripMs] = [180, 1000, 150].map((usual, i) => Number(process.argv[2 + i] ?? usual));
const WINDOW = { width: 1280, height: 720 };
const MIDDLE = { x: 640, y: 360 };
const STEP_MS = 33;
const REPORT_MS = 10_000;
const SWING_PX = 300;
const STEP_PX = 5;

/**
 * Returns a position that moves back and forth at constant speed. If the camera slowed down at the ends, it would come
 * to rest there, and the server would send no moving pictures.
 */
function swing(step) {
  const along = (STEP_PX * step) % (4 * SWING_PX);
  return SWING_PX - Math.abs(along - 2 * SWING_PX);
}

const server = await startServer({ httpPort: await freePort(), grpcPort: await freePort() });
const link = await throttledLink({ port: Number(new URL(server.url).port), kbitPerS, roundTripMs });
const browser = await launchBrowser();
try {
  const page = await (await browser.newContext({ viewport: WINDOW })).newPage();
  await page.goto(`http://127.0.0.1:${link.port}/`);
  await rested(page);
  const summary = page.getByTestId("readout-summary");
  const end = Date.now() + 1000 * seconds;
  let report = Date.now() + REPORT_MS;
  let samples = [];
  let kinds = {};
  const all = [];
  await page.mouse.move(MIDDLE.x, MIDDLE.y);
  await page.mouse.down();
  for (let step = 0; Date.now() < end; step += 1) {
    const began = Date.now();
    await page.mouse.move(MIDDLE.x + swing(step), MIDDLE.y);
    if (step % 15 === 0) {
      const { framesPerSecond, latencyMs } = await summary.evaluate((element) => ({ ...element.dataset }));
      const { encoding } = await canvasData(page);
      samples.push({ fps: Number(framesPerSecond), ms: Number(latencyMs) });
      kinds[encoding] = (kinds[encoding] ?? 0) + 1;
    }
    if (Date.now() >= report) {
      const sorted = samples.map(({ ms }) => ms).sort((a, b) => a - b);
      const fps = samples.reduce((sum, one) => sum + one.fps, 0) / samples.length;
      const least = Math.min(...samples.map((one) => one.fps));
      const [median, most] = [sorted[sorted.length >> 1], sorted.at(-1)];
      console.log(`${fps.toFixed(1)} frames/s (least ${least}), latency ${median} ms (most ${most})`, JSON.stringify(kinds));
      all.push({ fps, median });
      samples = [];
      kinds = {};
      report += REPORT_MS;
    }
    await setTimeout(Math.max(0, STEP_MS - (Date.now() - began)));
  }
  await page.mouse.up();
  const third = Math.ceil(all.length / 3);
  const mean = (list) => list.reduce((sum, one) => sum + one.median, 0) / list.length;
  const fps = all.reduce((sum, one) => sum + one.fps, 0) / all.length;
  console.log(`figure: slow link, frames shown: ${fps.toFixed(1)} frames/s`);
  console.log(`figure: slow link, latency in the first third: ${mean(all.slice(0, third)).toFixed(0)} ms`);
  console.log(`figure: slow link, latency in the last third: ${mean(all.slice(-third)).toFixed(0)} ms`);
  const shown = await rested(page);
  console.log(`at rest: ${shown.encoding}`);
} finally {
  await browser.close();
  await link.close();
  await server.stop();
}
