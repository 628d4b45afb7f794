// Tests that video and resting frames in Chromium show the same picture as JPEG.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { canvasData, changing, chooseQuality, dragBetween, launchBrowser, listenForErrors, openTool, rested, restedAndFits, screenshot, until } from "./driver.mjs";
import { PNG } from "pngjs";
import { decodedAsFullRange, decodedByBt709, difference, grabCanvas, shareOfChange, spread } from "./pictures.mjs";
import { textOfCode } from "./qr.mjs";
import { freePort, startServer } from "./server_process.mjs";
import { throttledLink } from "./throttled_link.mjs";

// Pictures have half of the window's pixels, so that they cost less. The page's layout is the same.
const WINDOW = { viewport: { width: 1000, height: 700 }, deviceScaleFactor: 0.7 };
// The positions where the camera's turns begin and end.
const [LEFT, RIGHT] = [300, 500].map((x) => ({ x, y: 350 }));
// A host name other than localhost, which Chromium is told to resolve to this machine.
const OTHER_HOST = "storms.test";
// A JPEG frame takes 0.4 s over this link. The server tries smaller frames if one takes more than 0.1 s
// (server/delivery/link_estimate.h).
const SLOW_LINK = { kbitPerS: 500, roundTripMs: 150 };
// The maximum mean difference over all pixels, in levels of 255. JPEG at its own quality differs by 1.2 from the
// picture.
const ALIKE = 2.5;
// The tolerated fraction of the change that a wrong colour matrix or range would cause. A wrong matrix or range gives
// 1. Correct video of low quality, whose colours are paler, gives -0.26.
const SAME_COLOURS = 0.5;

let server;
let browser;
const complaints = [];

async function open(link, ...scripts) {
  const context = await browser.newContext(WINDOW);
  const page = await context.newPage();
  listenForErrors(page, complaints);
  for (const script of scripts) await page.addInitScript(script);
  await page.goto(link);
  return page;
}

// Scripts that make the page behave as in a browser that is asked to save data, and as in one that decodes neither VP9
// nor AVIF.
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

// Runs in the page. Records the sequence numbers of the frames shown, by encoding.
const watchCanvas = () => {
  const canvas = document.querySelector("[data-testid=storm-canvas]");
  window.seen = {};
  new MutationObserver(() => {
    const { encoding, sequence } = canvas.dataset;
    window.seen[encoding] ??= [];
    window.seen[encoding].push(sequence);
  }).observe(canvas, { attributeFilter: ["data-sequence"] });
};

// Opens a session whose pictures have no path-traced correction, in a browser that accepts only JPEG.
async function present(...scripts) {
  const page = await open(server.url, jpegOnly, ...scripts);
  await openTool(page, "look");
  await changing(() => chooseQuality(page, "Fast"), page);
  await openTool(page, undefined);
  return page;
}

// Turns the presenter's camera back and forth until `holds` returns true.
async function turningUntil(what, presenter, holds) {
  let [from, to] = [LEFT, RIGHT];
  await until(what, async () => {
    await dragBetween(presenter, from, to, 30);
    [from, to] = [to, from];
    return holds();
  });
}

before(async () => {
  const ports = { httpPort: await freePort(), grpcPort: await freePort() };
  server = await startServer({ ...ports, more: ["--allow-host", OTHER_HOST] });
  browser = await launchBrowser([`--host-resolver-rules=MAP ${OTHER_HOST} 127.0.0.1`]);
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

test("a browser that saves data sees video while the camera turns, and a resting frame of 10 bits", async () => {
  const presenter = await present();
  const link = presenter.url();
  const viewer = await open(link, savesData);
  await rested(viewer);
  await viewer.evaluate(watchCanvas);

  let numbers = [];
  // A busy machine shows few pictures in each turn.
  await turningUntil("ten pictures of video", presenter, async () => {
    numbers = ((await viewer.evaluate(() => window.seen.vp9)) ?? []).map(Number);
    return numbers.length >= 10;
  });
  assert.deepEqual(numbers, [...numbers].sort((a, b) => a - b), "pictures came out of order");

  await rested(presenter);
  let resting;
  let jpeg;
  // Both pictures are of the same frame.
  await until("the resting frame", async () => {
    const seen = await canvasData(viewer);
    if (seen.encoding !== "avif" || seen.refined !== "true") return false;
    [resting, jpeg] = [await grabCanvas(viewer), await grabCanvas(presenter)];
    const after = [await canvasData(viewer), await canvasData(presenter)];
    return after.every(({ sequence }) => sequence === seen.sequence);
  });
  assert.equal((await canvasData(presenter)).encoding, "jpeg");
  assert.ok(spread(resting).deviation > 10, "the resting frame is blank");
  const apart = difference(resting, jpeg);
  assert.ok(apart < ALIKE, `the resting frame is ${apart} levels from JPEG`);
  await viewer.getByTestId("readout-summary").click();
  await until("the readout's word for it", async () => /AVIF/.test(await viewer.getByTestId("encoding").innerText()));
  await screenshot("resting-frame-avif", viewer);
  assert.deepEqual(complaints, []);
});

// Returns the readout's text about the encoding of the picture shown.
async function sentAs(page) {
  await page.getByTestId("readout-summary").click();
  const text = await page.getByTestId("encoding").innerText();
  await page.getByTestId("readout-summary").click();
  return text;
}

test("where there is no video the pictures are JPEG or resting frames, and the readout says why", async () => {
  const old = await open(server.url, jpegOnly);
  await rested(old);
  assert.equal(await sentAs(old), "JPEG; this browser has no WebCodecs");
  await old.context().close();

  const plain = await open(server.url.replace("127.0.0.1", OTHER_HOST));
  await rested(plain);
  assert.equal(await plain.evaluate(() => isSecureContext), false);
  await until("the resting frame", async () => (await sentAs(plain)) === "AVIF, 10 bits; video needs HTTPS or localhost");
  // Other machines can reach such an address, so Share does not warn.
  await plain.getByTestId("share").click();
  const link = await plain.getByTestId("viewers-link").inputValue();
  assert.equal(new URL(link).hostname, OTHER_HOST);
  assert.equal(await textOfCode(plain), link);
  assert.equal(await plain.getByTestId("only-here").count(), 0);
  await plain.keyboard.press("Escape");
  await plain.getByTestId("readout-summary").click();
  await screenshot("plain-http", plain);
  await plain.context().close();
});

test("by a slow link come video, or smaller pictures where the browser decodes none", async () => {
  const links = [];
  for (let i = 0; i < 2; i += 1)
    links.push(await throttledLink({ port: Number(new URL(server.url).port), ...SLOW_LINK }));
  try {
    const presenter = await present();
    const session = new URL(presenter.url()).search;
    const slow = await open(`http://127.0.0.1:${links[0].port}/${session}`);
    const old = await open(`http://127.0.0.1:${links[1].port}/${session}`, jpegOnly);
    for (const page of [slow, old]) await rested(page);
    // At rest both pages have the full picture.
    assert.equal((await canvasData(old)).tier, "0");

    const reached = { video: false, smaller: false };
    // A machine that draws few frames takes long to find that they are too large.
    await turningUntil("video, and smaller pictures", presenter, async () => {
      reached.video ||= (await canvasData(slow)).encoding === "vp9";
      const { tier, encoding } = await canvasData(old);
      assert.equal(encoding, "jpeg");
      reached.smaller ||= tier !== "0";
      return reached.video && reached.smaller;
    });
    await old.getByTestId("readout-summary").click();
    await screenshot("slow-link", old);
    // Resting frames keep their full size even on a slow link.
    await until("the full picture at rest", async () => {
      const { tier, refined } = await canvasData(old);
      return tier === "0" && refined === "true";
    });
  } finally {
    for (const link of links) await link.close();
  }
});

test("the colours of video are those of JPEG", async () => {
  // Keeps the latest pictures drawn, except resting frames, by sequence number, with the data that the page reports
  // about them.
  const keepsPictures = () => {
    window.pictures = new Map();
    const drawImage = CanvasRenderingContext2D.prototype.drawImage;
    CanvasRenderingContext2D.prototype.drawImage = function draw(picture, ...rest) {
      drawImage.call(this, picture, ...rest);
      const { canvas } = this;
      if (canvas.dataset?.testid !== "storm-canvas") return;
      const copy = new OffscreenCanvas(canvas.width, canvas.height);
      copy.getContext("2d").drawImage(canvas, 0, 0);
      // The page reports the data right after drawing.
      queueMicrotask(() => {
        const data = { ...canvas.dataset };
        if (data.encoding === "avif") return;
        window.pictures.set(data.sequence, { copy, data });
        if (window.pictures.size > 30) window.pictures.delete(window.pictures.keys().next().value);
      });
    };
  };
  const dataOf = (page) => page.evaluate(() => [...window.pictures.values()].map(({ data }) => data));
  const pictureOf = async (page, sequence) => {
    const dataUrl = await page.evaluate(async (sequence) => {
      const reader = new FileReader();
      reader.readAsDataURL(await window.pictures.get(sequence).copy.convertToBlob({ type: "image/png" }));
      await new Promise((done) => reader.addEventListener("load", done));
      return reader.result;
    }, sequence);
    return PNG.sync.read(Buffer.from(dataUrl.split(",")[1], "base64"));
  };
  const presenter = await present(keepsPictures);
  // Strong colours make a wrong matrix visible.
  await openTool(presenter, "look");
  await changing(() => presenter.getByTestId("colours").getByText("False colours").click(), presenter);
  await openTool(presenter, undefined);
  await restedAndFits(presenter);
  const viewer = await open(presenter.url(), savesData, keepsPictures);
  await rested(viewer);
  // Compares one frame in both encodings, in full quality, because moving pictures may be coarse. Either page may have
  // skipped it.
  let rightPx = 120;
  let sequence;
  await until("a frame that rests, as video and as JPEG", async () => {
    await dragBetween(presenter, LEFT, { x: LEFT.x + rightPx, y: LEFT.y }, 20);
    rightPx = -rightPx;
    await rested(presenter);
    const { revision } = await canvasData(presenter);
    await until("the resting frame", async () => {
      const seen = await canvasData(viewer);
      return seen.encoding === "avif" && seen.revision === revision;
    });
    const jpegs = (await dataOf(presenter)).map((data) => data.sequence);
    const both = (await dataOf(viewer)).filter(
      (data) =>
        data.encoding === "vp9" && data.refined === "true" && Number(data.scale) === 1 && jpegs.includes(data.sequence),
    );
    sequence = both.at(-1)?.sequence;
    return sequence !== undefined;
  });
  const [video, jpeg] = [await pictureOf(viewer, sequence), await pictureOf(presenter, sequence)];
  // A slow machine receives smaller video pictures of lower quality, so absolute differences say little.
  for (const [what, wrong] of Object.entries({ matrix: decodedByBt709(jpeg), range: decodedAsFullRange(jpeg) })) {
    const share = shareOfChange(video, jpeg, wrong);
    console.log(`share of another ${what}: ${share.toFixed(3)}`);
    assert.ok(Math.abs(share) < SAME_COLOURS, `video has ${share} of another ${what}`);
  }
});
