// Measures a drag with server and browser on this machine: frames a second, and milliseconds from the pointer to the picture.
//   node drag.mjs [seconds] [width] [height]
import { setTimeout } from "node:timers/promises";
import { launchBrowser, rested } from "./driver.mjs";
import { freePort, startServer } from "./server_process.mjs";

const [seconds, width, height] = [20, 960, 540].map((usual, i) => Number(process.argv[2 + i] ?? usual));
const STEP_MS = 16;
// Warm-up: the first pictures of a drag are not representative.
const WARM_MS = 3000;

const server = await startServer({ httpPort: await freePort(), grpcPort: await freePort() });
const browser = await launchBrowser();
try {
  const page = await (await browser.newContext({ viewport: { width, height } })).newPage();
  await page.goto(server.url);
  await rested(page);
  const summary = page.getByTestId("readout-summary");
  await page.mouse.move(width / 2, height / 2);
  await page.mouse.down();
  const samples = [];
  const began = Date.now();
  for (let step = 0; Date.now() - began < 1000 * seconds; step += 1) {
    const at = Date.now();
    await page.mouse.move(width / 2 + 0.2 * width * Math.sin(step / 30), height / 2);
    if (step % 30 === 0 && at - began > WARM_MS) {
      const { framesPerSecond, latencyMs } = await summary.evaluate((element) => ({ ...element.dataset }));
      samples.push({ fps: Number(framesPerSecond), ms: Number(latencyMs) });
    }
    await setTimeout(Math.max(0, STEP_MS - (Date.now() - at)));
  }
  await page.mouse.up();
  const middle = (values) => values.sort((a, b) => a - b)[values.length >> 1];
  const [fps, ms] = [middle(samples.map((one) => one.fps)), middle(samples.map((one) => one.ms))];
  console.log(`${width} x ${height}, ${seconds} s: ${fps} frames/s, ${ms} ms from pointer to picture (medians)`);
} finally {
  await browser.close();
  await server.stop();
}
