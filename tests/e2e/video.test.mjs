// Video and stills of higher quality in Chromium: drawn as JPEG draws them.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { canvasData, dragBetween, launchBrowser, listenForErrors, rested, screenshot, until } from "./driver.mjs";
import { PNG } from "pngjs";
import { blockDifference, difference, grabCanvas, spread } from "./pictures.mjs";
import { freePort, startServer } from "./server_process.mjs";

const WINDOW = { width: 1000, height: 700 };
// Levels of 255: mean over all pixels. JPEG at its own quality is 1.2 from the picture.
const ALIKE = 2.5;
// Of means of blocks; colours of another range or matrix are 4 and more apart.
const SAME_COLOURS = 1.5;

let server;
let browser;
const complaints = [];

async function open(link, init) {
  const context = await browser.newContext({ viewport: WINDOW });
  const page = await context.newPage();
  listenForErrors(page, complaints);
  if (init !== undefined) await page.addInitScript(init);
  await page.goto(link);
  return page;
}

// As a browser that is asked to save data, and as one that decodes neither VP9 nor AVIF.
const savesData = () =>
  Object.defineProperty(navigator.connection, "saveData", { get: () => true });
const jpegOnly = () => {
  delete window.VideoDecoder;
  const decode = window.createImageBitmap;
  window.createImageBitmap = (source, ...rest) =>
    source instanceof Blob && source.type === "image/avif"
      ? Promise.reject(new Error("no AVIF"))
      : decode(source, ...rest);
};

// Counts, in the page, the frames that are shown in each encoding.
const watchCanvas = () => {
  window.seen = {};
  window.watching = setInterval(() => {
    const canvas = document.querySelector("[data-testid=storm-canvas]");
    if (canvas === null || canvas.dataset.encoding === undefined) return;
    const { encoding, sequence } = canvas.dataset;
    window.seen[encoding] ??= { count: 0, sequences: [] };
    const seen = window.seen[encoding];
    if (seen.sequences.at(-1) === sequence) return;
    seen.count += 1;
    seen.sequences.push(sequence);
  }, 8);
};

before(async () => {
  server = await startServer({ httpPort: await freePort(), grpcPort: await freePort() });
  browser = await launchBrowser();
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

test("a browser that saves data sees video while the camera turns, and a still of 10 bits at rest", async () => {
  const presenter = await open(server.url, jpegOnly);
  await rested(presenter);
  const link = presenter.url();
  const viewer = await open(link, savesData);
  await rested(viewer);
  await viewer.evaluate(watchCanvas);

  let shown = 0;
  for (let round = 0; round < 4; round += 1) {
    const x = round % 2 === 0 ? 300 : 500;
    await dragBetween(presenter, { x, y: 350 }, { x: 800 - x, y: 350 }, 30);
    shown = (await viewer.evaluate(() => window.seen.vp9?.count)) ?? 0;
  }
  assert.ok(shown >= 10, `only ${shown} pictures of video were shown`);
  const { sequences } = await viewer.evaluate(() => window.seen.vp9);
  const numbers = sequences.map(Number);
  assert.deepEqual(numbers, [...numbers].sort((a, b) => a - b), "pictures came out of order");

  await rested(presenter);
  await until("the still", async () => {
    const [seen, drawn] = [await canvasData(viewer), await canvasData(presenter)];
    return seen.encoding === "avif" && seen.revision === drawn.revision && seen.refined === "true";
  });
  assert.equal((await canvasData(presenter)).encoding, "jpeg");
  const still = await grabCanvas(viewer);
  const jpeg = await grabCanvas(presenter);
  assert.ok(spread(still).deviation > 10, "the still is blank");
  const apart = difference(still, jpeg);
  assert.ok(apart < ALIKE, `the still is ${apart} levels from JPEG`);
  await viewer.getByTestId("readout-summary").click();
  assert.match(await viewer.getByTestId("encoding").innerText(), /AVIF/);
  await screenshot("still-avif", viewer);
  assert.deepEqual(complaints, []);
});

test("the colours of video are those of JPEG", async () => {
  // Keeps the last picture of video that was drawn.
  const keepsVideo = () => {
    Object.defineProperty(navigator.connection, "saveData", { get: () => true });
    const drawImage = CanvasRenderingContext2D.prototype.drawImage;
    CanvasRenderingContext2D.prototype.drawImage = function draw(picture, ...rest) {
      drawImage.call(this, picture, ...rest);
      const { canvas } = this;
      if (picture instanceof VideoFrame) window.lastVideo = canvas.toDataURL("image/png");
    };
  };
  const presenter = await open(server.url, jpegOnly);
  await rested(presenter);
  const viewer = await open(presenter.url(), keepsVideo);
  await rested(viewer);
  await dragBetween(presenter, { x: 300, y: 350 }, { x: 420, y: 350 }, 20);
  await rested(presenter);
  await until("the still", async () => {
    const [seen, drawn] = [await canvasData(viewer), await canvasData(presenter)];
    return seen.encoding === "avif" && seen.revision === drawn.revision;
  });
  // The still's picture came as video first.
  const dataUrl = await viewer.evaluate(() => window.lastVideo);
  const video = PNG.sync.read(Buffer.from(dataUrl.split(",")[1], "base64"));
  // Of blocks, as a slow machine gets smaller pictures of video.
  const apart = blockDifference(video, await grabCanvas(presenter));
  assert.ok(apart < SAME_COLOURS, `video is ${apart} levels from JPEG`);
});
