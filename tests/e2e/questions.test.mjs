// End-to-end tests of two of a forecaster's questions, by mouse and by keys alone: what changed between the last two runs, and
// send this view to a colleague. Two runs of a model on the real server: the later one has a larger cloud.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { PNG } from "pngjs";
import { runFile } from "./cloud_file.mjs";
import {
  canvasData,
  changing,
  dragBetween,
  launchBrowser,
  listenForErrors,
  openPanel,
  openTool,
  PICTURE_TIMEOUT_MS,
  rested,
  screenshot,
  until,
} from "./driver.mjs";
import { difference, grabCanvas, greyShare } from "./pictures.mjs";
import { freePort, startServer } from "./server_process.mjs";

// Wide enough for the run in the bar.
const VIEWPORT = { width: 1280, height: 620 };
const RUNS = [
  { start: 0, times: [0, 6, 7, 8], radiusM: 1800 },
  { start: 6, times: [6, 7, 8], radiusM: 3200 },
];
const twoDigits = (hour) => String(hour).padStart(2, "0");
const complaints = [];
let folder;
let server;
let browser;
let page;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "thunderhead-questions-"));
  for (const { start, times, radiusM } of RUNS) {
    const run = join(folder, `run_${twoDigits(start)}`);
    mkdirSync(run);
    for (const hour of times) {
      const [began, valid] = [start, hour].map((each) => `2020-05-20_${twoDigits(each)}:00:00`);
      writeFileSync(join(run, `wrfout_d01_${valid}`), runFile(began, valid, radiusM));
    }
  }
  server = await startServer({ httpPort: await freePort(), grpcPort: await freePort(), data: folder });
  browser = await launchBrowser();
  page = await visit(server.url);
  await openTool(page, "look");
  await page.locator("[data-testid=quality-choice] input:checked").waitFor({ state: "attached", timeout: PICTURE_TIMEOUT_MS });
  await page.getByTestId("quality-choice").getByText("Fast", { exact: true }).click();
  await openTool(page, undefined);
  await rested(page);
  // Not the last time, which is the last of both runs: this one has another place in each.
  await focusPicture();
  await changing(() => key(","), page);
});

after(async () => {
  await browser?.close();
  await server?.stop();
  rmSync(folder, { recursive: true, force: true });
});

// A page of somebody else: nothing in its storage.
async function visit(url) {
  const context = await browser.newContext({ viewport: VIEWPORT, permissions: ["clipboard-read", "clipboard-write"] });
  const opened = await context.newPage();
  listenForErrors(opened, complaints);
  await opened.goto(url);
  await rested(opened);
  return opened;
}

// Of what is on the screen: texts of what is hidden can be read too.
async function text(id) {
  const shown = page.getByTestId(id);
  await shown.waitFor({ state: "visible" });
  return shown.innerText();
}

const key = (name) => page.keyboard.press(name);
const focusPicture = () => page.getByTestId("storm-canvas").focus();
const focused = () => page.evaluate(() => document.activeElement?.dataset.testid);

// Moves the focus with the tabulator key until it is on an element.
async function tabTo(testId, most = 40) {
  for (let presses = 0; presses < most; presses += 1) {
    if ((await focused()) === testId) return;
    await key("Tab");
  }
  throw new Error(`the tabulator key does not reach ${testId}`);
}

const chosen = (testId) => page.getByTestId(testId).evaluate(({ selectedOptions }) => selectedOptions[0].label);

async function comparedPicture() {
  const url = await page.getByTestId("compared-canvas").evaluate((canvas) => canvas.toDataURL("image/png"));
  return PNG.sync.read(Buffer.from(url.split(",")[1], "base64"));
}

// The bar says of A and B which runs they are, both at the same valid time; B has the larger cloud.
async function assertRunsCompared() {
  const compared = page.getByTestId("compared-canvas");
  await until("B's picture", () => compared.evaluate(({ dataset }) => dataset.refined === "true"));
  await until("B's time", async () => /07:00Z/.test(await text("name-b")));
  assert.match(await text("name-a"), /run 2020-05-20 00:00Z, 2020-05-20 07:00Z/);
  assert.match(await text("name-b"), /run 2020-05-20 06:00Z, 2020-05-20 07:00Z/);
  const [before, after] = [await grabCanvas(page), await comparedPicture()].map((picture) => greyShare(picture));
  assert.ok(after > 1.5 * before, `the later run has cloud in ${after} of its picture, the earlier in ${before}`);
}

async function edgePercent() {
  const clip = await page.getByTestId("compared-canvas").evaluate(({ style }) => style.clipPath);
  return Number(/([\d.]+)%\)/.exec(clip)[1]);
}

test("what changed between the last two runs, by mouse", async () => {
  assert.match(await text("run"), /run 2020-05-20 00:00Z/);
  assert.match(await text("top-time"), /07:00Z/);
  await openPanel(page, "compare");
  await page.getByTestId("compare-storm").selectOption({ index: 1 });
  assert.match(await chosen("compare-storm"), /run_06/);
  await page.getByTestId("compare").click();
  await assertRunsCompared();
  const { x, y, width, height } = await page.getByTestId("swipe").boundingBox();
  await dragBetween(page, { x: x + width / 2, y: y + height / 2 }, { x: x + 0.3 * width, y: y + height / 2 });
  const edge = await edgePercent();
  assert.ok(edge > 25 && edge < 35, `after a drag to 30 % the edge is at ${edge} %`);
  await screenshot("questions-runs", page);
  await openPanel(page, "compare");
  await page.getByTestId("compare-end").click();
  await page.getByTestId("compare").click();
});

test("what changed between the last two runs, by keys alone", async () => {
  await focusPicture();
  await key("c");
  await tabTo("compare-storm");
  await key("ArrowDown");
  assert.match(await chosen("compare-storm"), /run_06/);
  await key("Escape");
  await assertRunsCompared();
  await tabTo("swipe", 60);
  const before = await edgePercent();
  for (let presses = 0; presses < 5; presses += 1) await key("ArrowLeft");
  assert.equal(await edgePercent(), before - 5);
  await focusPicture();
  await key("c");
  await tabTo("compare-end");
  await key("Enter");
  assert.equal(await page.getByTestId("compared-canvas").count(), 0);
  await key("Escape");
});

// A fresh page at the link shows what this page shows.
async function assertSameView(link) {
  const here = await rested(page);
  const colleague = await visit(link);
  try {
    const same = ["camera", "azimuth", "distance", "time"];
    await until("the same view", async () => {
      const there = await canvasData(colleague);
      return same.every((name) => there[name] === here[name]);
    });
    await rested(colleague);
    assert.equal(await colleague.getByTestId("run").innerText(), await text("run"));
    assert.equal(await colleague.getByTestId("top-time").innerText(), await text("top-time"));
    const apart = difference(await grabCanvas(page), await grabCanvas(colleague));
    assert.ok(apart < 1, `the pictures differ by ${apart}`);
    assert.match(await text("people"), /2/);
  } finally {
    await colleague.context().close();
  }
}

const copied = async () => {
  await page.getByText("Link copied").waitFor();
  return page.evaluate(() => navigator.clipboard.readText());
};

test("send this view to a colleague, by mouse", async () => {
  await changing(() => dragBetween(page, { x: 400, y: 300 }, { x: 520, y: 280 }), page);
  const first = await canvasData(page);
  await openPanel(page, "share");
  await page.getByTestId("copy-link").click();
  const link = await copied();
  await page.getByTestId("share").click();
  await assertSameView(link);
  assert.equal((await canvasData(page)).azimuth, first.azimuth, "somebody who watches turns nothing");
});

test("send this view to a colleague, by keys alone", async () => {
  await focusPicture();
  await changing(async () => {
    for (let presses = 0; presses < 4; presses += 1) await key("ArrowRight");
    await key("ArrowUp");
  }, page);
  await page.evaluate(() => navigator.clipboard.writeText(""));
  await focusPicture();
  await key("h");
  await tabTo("copy-link");
  await key("Enter");
  const link = await copied();
  await key("Escape");
  await assertSameView(link);
});

test("a link to a view outlives the session that it was made in", async () => {
  await openPanel(page, "keep");
  await page.getByTestId("keep-scene").locator("summary").click();
  await page.evaluate(() => navigator.clipboard.writeText(""));
  await page.getByTestId("keep-link").click();
  const link = await copied();
  await page.keyboard.press("Escape");
  const here = await rested(page);
  const picture = await grabCanvas(page);
  await openPanel(page, "share");
  await page.getByTestId("end-session").click();
  await page.getByTestId("end-session").click();
  await page.getByTestId("open-new").waitFor();
  const context = await browser.newContext({ viewport: VIEWPORT });
  const colleague = await context.newPage();
  await colleague.goto(link);
  const there = await rested(colleague);
  assert.deepEqual([there.azimuth, there.distance, there.time], [here.azimuth, here.distance, here.time]);
  assert.ok(difference(picture, await grabCanvas(colleague)) < 1, "the pictures differ");
  await context.close();
});

test("no error reached the browser's console", () => {
  assert.deepEqual(complaints, []);
});
