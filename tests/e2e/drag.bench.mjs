// Measures a drag with server and browser on this machine. It reports frames painted per second and the latency in
// milliseconds. The latency begins at the browser's timestamp of a pointer movement. It ends when the page paints a
// picture that shows this movement.
//   node drag.bench.mjs [seconds] [width] [height] [trace]
//
// The aims, at 960 x 540, are 20 frames/s and a median of 120 ms. With `trace` it also prints what a picture costs the
// browser, from a trace of one more drag.
import { loadavg } from "node:os";
import { setTimeout } from "node:timers/promises";
import { launchBrowser, rested, until } from "./driver.mjs";
import { freePort, startServer } from "./server_process.mjs";

const [seconds, width, height] = [20, 960, 540].map((usual, i) => Number(process.argv[2 + i] ?? usual));
const STEP_MS = 16;
const STEP_PX = 4;
// The angle by which a drag over the whole window's height turns the camera.
const TURN_DEG = 180;
// Rounding error of the azimuth that the page reports.
const ROUNDING_DEG = 0.02;

// Runs in the page. Records the pointer's movements, and the azimuth of each picture once it is painted.
const record = () => {
  const canvas = document.querySelector("[data-testid=storm-canvas]");
  window.drag = { moved: [], painted: [] };
  canvas.addEventListener("pointermove", (event) => {
    for (const { clientX, timeStamp } of event.getCoalescedEvents()) window.drag.moved.push({ x: clientX, atMs: timeStamp });
  });
  // The observer is called before the frame is painted, and a message arrives after that.
  const channel = new MessageChannel();
  channel.port1.onmessage = ({ data }) => window.drag.painted.push({ azimuthDeg: data, atMs: performance.now() });
  new MutationObserver(() => channel.port2.postMessage(Number(canvas.dataset.azimuth))).observe(canvas, {
    attributeFilter: ["data-sequence"],
  });
};

const azimuthOf = (page) => page.getByTestId("storm-canvas").evaluate(({ dataset }) => Number(dataset.azimuth));

// Drags once from left to right, so that each azimuth belongs to one position of the pointer.
async function stroke(page) {
  const [left, right, middle] = [0.1 * width, 0.9 * width, height / 2];
  const firstDeg = await azimuthOf(page);
  const turnedDeg = (azimuthDeg) => ((azimuthDeg - firstDeg + 360 + 20) % 360) - 20;
  await page.mouse.move(left, middle);
  await page.mouse.down();
  await page.evaluate(() => Object.assign(window.drag, { moved: [], painted: [] }));
  for (let x = left + STEP_PX; x <= right; x += STEP_PX) {
    const at = Date.now();
    await page.mouse.move(x, middle);
    await setTimeout(Math.max(0, STEP_MS - (Date.now() - at)));
  }
  const { moved, painted } = await page.evaluate(async () => {
    const { dataset } = document.querySelector("[data-testid=storm-canvas]");
    // Waits for the picture of the last movement, which is recorded a frame later.
    while (!dataset.agreed || Number(dataset.revision) < Number(dataset.agreed)) await new Promise(requestAnimationFrame);
    for (let i = 0; i < 2; i += 1) await new Promise(requestAnimationFrame);
    return window.drag;
  });
  await page.mouse.up();
  const pictures = painted.map(({ azimuthDeg, atMs }) => ({ deg: turnedDeg(azimuthDeg), atMs }));
  const latenciesMs = moved.map(({ x, atMs }) => {
    const deg = ((x - left) / height) * TURN_DEG;
    const picture = pictures.find((each) => each.deg > deg - ROUNDING_DEG);
    if (picture === undefined) throw new Error(`no picture shows the pointer at ${x}: the last is turned by ${pictures.at(-1)?.deg} degrees`);
    return picture.atMs - atMs;
  });
  const [begin, end] = [moved[0].atMs, moved.at(-1).atMs];
  const frames = pictures.filter(({ atMs }) => atMs >= begin && atMs <= end).length;
  return { latenciesMs, frames, ms: end - begin };
}

// The parts whose CPU time is reported; other processes do not affect CPU time. The first part is the whole main thread
// of the page. The next two are contained in it: callbacks before a frame, which draw the picture, and layer updates,
// which copy the canvas for the compositor. The last part is decoding on other threads.
const PARTS = {
  "the main thread": { thread: "CrRendererMain", event: "RunTask" },
  "its callbacks before frames": { thread: "CrRendererMain", event: "FireAnimationFrame" },
  "its updates of layers": { thread: "CrRendererMain", event: "LayerTreeHost::DoUpdateLayers" },
  "decoding elsewhere": { thread: "ThreadPoolForegroundWorker", event: "Decode Image" },
};

async function costsOfPicture(page) {
  await browser.startTracing(page, { categories: ["toplevel", "cc", "blink", "devtools.timeline", "disabled-by-default-devtools.timeline"] });
  const { frames } = await stroke(page);
  const { traceEvents } = JSON.parse(await browser.stopTracing());
  const threads = new Map();
  for (const { name, pid, tid, args } of traceEvents) if (name === "thread_name") threads.set(`${pid} ${tid}`, args.name);
  return Object.entries(PARTS).map(([part, { thread, event }]) => {
    const own = traceEvents.filter(({ name, pid, tid }) => name === event && threads.get(`${pid} ${tid}`) === thread);
    const ms = own.reduce((sum, { tdur = 0 }) => sum + tdur / 1000, 0);
    if (ms === 0) throw new Error(`the trace has no ${event} on ${thread}`);
    return `${part} ${(ms / frames).toFixed(1)} ms`;
  });
}

const server = await startServer({ httpPort: await freePort(), grpcPort: await freePort() });
const browser = await launchBrowser();
try {
  const page = await (await browser.newContext({ viewport: { width, height } })).newPage();
  await page.goto(server.url);
  await rested(page);
  await page.evaluate(record);
  // The first stroke is a warm-up, because the first moving pictures are not representative.
  await stroke(page);
  const strokes = [];
  const total = (what) => strokes.reduce((sum, each) => sum + each[what], 0);
  await until("drags", async () => {
    strokes.push(await stroke(page));
    return total("ms") >= 1000 * seconds;
  });
  const percentileOf = (some) => {
    const sorted = some.flatMap(({ latenciesMs }) => latenciesMs).sort((a, b) => a - b);
    return (share) => sorted[Math.floor(share * sorted.length)].toFixed(0);
  };
  const half = Math.ceil(strokes.length / 2);
  console.log(`${width} x ${height}, ${(total("ms") / 1000).toFixed(0)} s; the machine's load ${loadavg()[0].toFixed(1)}`);
  console.log(`figure: drag, frames shown: ${((1000 * total("frames")) / total("ms")).toFixed(1)} frames/s`);
  console.log(`figure: drag, pointer to picture, median: ${percentileOf(strokes)(0.5)} ms`);
  console.log(`figure: drag, pointer to picture, 95th percentile: ${percentileOf(strokes)(0.95)} ms`);
  console.log(`figure: drag, pointer to picture, median of the first half: ${percentileOf(strokes.slice(0, half))(0.5)} ms`);
  console.log(`figure: drag, pointer to picture, median of the last half: ${percentileOf(strokes.slice(-half))(0.5)} ms`);
  if (process.argv[5] === "trace") console.log(`CPU time a picture: ${(await costsOfPicture(page)).join(", ")}`);
} finally {
  await browser.close();
  await server.stop();
}
