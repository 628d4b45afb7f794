// End-to-end tests of three of a forecaster's questions, by mouse and by keyboard alone. The questions are: what
// changed between the last two runs, send this view to a colleague, and make a movie of the next two hours. Two runs of
// a model are on the real server, and the later one has a larger cloud.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { PNG } from "pngjs";
import { PLACE, runFile } from "./cloud_file.mjs";
import {
  atOneMoment,
  canvasData,
  changing,
  chooseQuality,
  dragBetween,
  grabRestingFrame,
  holdingMovie,
  launchBrowser,
  listenForErrors,
  openPanel,
  openTool,
  rested,
  restedAndFits,
  screenshot,
  tabTo,
  timed,
  until,
} from "./driver.mjs";
import { boxMean, difference, grabCanvas, greyShare } from "./pictures.mjs";
import { freePort, startServer } from "./server_process.mjs";

const VIEWPORT = { width: 1280, height: 620 };
// Pictures have a quarter of the window's pixels: they cost less, and the page's layout is the same.
const WINDOW = { viewport: VIEWPORT };
const RUNS = [
  { start: 0, times: [0, 6, 7, 8], radiusM: 1800 },
  { start: 6, times: [6, 7, 8], radiusM: 3200 },
];
const twoDigits = (hour) => String(hour).padStart(2, "0");
const complaints = [];
let folder;
let server;
let placeServer;
let browser;
let page;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "thunderhead-questions-"));
  for (const { start, times, radiusM } of RUNS) {
    const run = join(folder, "runs", `run_${twoDigits(start)}`);
    mkdirSync(run, { recursive: true });
    for (const hour of times) {
      const [began, valid] = [start, hour].map((each) => `2020-05-20_${twoDigits(each)}:00:00`);
      writeFileSync(join(run, `wrfout_d01_${valid}`), runFile(began, valid, radiusM));
    }
  }
  server = await startServer({ httpPort: await freePort(), grpcPort: await freePort(), data: join(folder, "runs") });
  browser = await launchBrowser();
  page = await visit(server.url);
  await openTool(page, "look");
  await chooseQuality(page, "Fast");
  await openTool(page, undefined);
  await rested(page);
  // The test goes to the previous valid time, which has a different index in each run. The last time would be the last
  // one in both runs.
  await changing(() => key(","), page);
});

after(async () => {
  await browser?.close();
  await server?.stop();
  await placeServer?.stop();
  rmSync(folder, { recursive: true, force: true });
});

// Opens a page as another person, with empty storage.
async function visit(url, prepare = async () => undefined) {
  const context = await browser.newContext({ ...WINDOW, permissions: ["clipboard-read", "clipboard-write"] });
  const opened = await context.newPage();
  listenForErrors(opened, complaints);
  await prepare(opened);
  await opened.goto(url);
  await rested(opened);
  return opened;
}

// Returns the text of an element after checking that the element is visible, because hidden elements also have text.
async function text(id) {
  const shown = page.getByTestId(id);
  await shown.waitFor({ state: "visible" });
  return shown.innerText();
}

const key = (name) => page.keyboard.press(name);
const chosen = (testId) => page.getByTestId(testId).evaluate(({ selectedOptions }) => selectedOptions[0].label);

async function comparedPicture() {
  const url = await page.getByTestId("compared-canvas").evaluate((canvas) => canvas.toDataURL("image/png"));
  return PNG.sync.read(Buffer.from(url.split(",")[1], "base64"));
}

// Checks that the bar names the runs of A and B, both at the same valid time, and that B has the larger cloud.
async function assertRunsCompared() {
  await until("B's time", async () => /07:00Z/.test(await text("name-b")));
  await restedAndFits(page);
  await restedAndFits(page, "compared-canvas");
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
  await timed("what changed between the last two runs, by mouse", async () => {
    await openPanel(page, "compare");
    await page.getByTestId("compare-storm").selectOption({ index: 1 });
    assert.match(await chosen("compare-storm"), /run_06/);
    await page.getByTestId("compare").click();
    await assertRunsCompared();
  });
  const { x, y, width, height } = await page.getByTestId("swipe").boundingBox();
  await dragBetween(page, { x: x + width / 2, y: y + height / 2 }, { x: x + 0.3 * width, y: y + height / 2 });
  const edge = await edgePercent();
  assert.ok(edge > 25 && edge < 35, `after a drag to 30 % the edge is at ${edge} %`);
  const nameOfA = await page.getByTestId("name-a").boundingBox();
  assert.ok(nameOfA.x + nameOfA.width <= (edge / 100) * VIEWPORT.width, "the edge cuts A's name");
  await screenshot("questions-runs", page);
  await openPanel(page, "compare");
  await page.getByTestId("compare-end").click();
  await page.getByTestId("compare").click();
});

test("what changed between the last two runs, by keys alone", async () => {
  await timed("what changed between the last two runs, by keys", async () => {
    await key("c");
    await tabTo(page, "compare-storm");
    await key("ArrowDown");
    assert.match(await chosen("compare-storm"), /run_06/);
    await key("Escape");
    await assertRunsCompared();
  });
  await tabTo(page, "swipe");
  const before = await edgePercent();
  for (let presses = 0; presses < 5; presses += 1) await key("ArrowLeft");
  assert.equal(await edgePercent(), before - 5);
  await key("c");
  await tabTo(page, "compare-end");
  await key("Enter");
  assert.equal(await page.getByTestId("compared-canvas").count(), 0);
  await key("Escape");
});

// Checks that a fresh page at the link shows what this page shows.
async function assertSameView(link) {
  const { data: here, picture } = await grabRestingFrame(page);
  const colleague = await visit(link);
  try {
    const same = ["camera", "azimuth", "distance", "time"];
    await until("the same view", async () => {
      const there = await canvasData(colleague);
      return same.every((name) => there[name] === here[name]);
    });
    const { picture: theirs } = await grabRestingFrame(colleague);
    assert.equal(await colleague.getByTestId("run").innerText(), await text("run"));
    assert.equal(await colleague.getByTestId("top-time").innerText(), await text("top-time"));
    const apart = difference(picture, theirs);
    assert.ok(apart < 1, `the pictures differ by ${apart}`);
    assert.match(await text("people"), /2/);
  } finally {
    await colleague.context().close();
  }
}

// Returns the link that an action copies. The note about it disappears after a while.
async function copied(action) {
  await atOneMoment(page, async () => {
    await action();
    await page.getByText("Link copied").waitFor();
  });
  return page.evaluate(() => navigator.clipboard.readText());
}

test("send this view to a colleague, by mouse", async () => {
  await changing(() => dragBetween(page, { x: 400, y: 300 }, { x: 520, y: 280 }), page);
  const first = await canvasData(page);
  await timed("send this view to a colleague, by mouse", async () => {
    await openPanel(page, "share");
    const link = await copied(() => page.getByTestId("copy-link").click());
    await page.getByTestId("share").click();
    await assertSameView(link);
  });
  assert.equal((await canvasData(page)).azimuth, first.azimuth, "somebody who watches turns nothing");
});

test("send this view to a colleague, by keys alone", async () => {
  await tabTo(page, "storm-canvas");
  await changing(async () => {
    for (let presses = 0; presses < 4; presses += 1) await key("ArrowRight");
    await key("ArrowUp");
  }, page);
  await page.evaluate(() => navigator.clipboard.writeText(""));
  await timed("send this view to a colleague, by keys", async () => {
    await key("h");
    await tabTo(page, "copy-link");
    const link = await copied(() => key("Enter"));
    await key("Escape");
    await assertSameView(link);
  });
});

// Returns the number of pictures and the seconds of a movie.
function lengthOf(file) {
  const shown = ["-show_entries", "stream=nb_read_frames:format=duration", "-of", "json"];
  const { streams, format } = JSON.parse(
    execFileSync("ffprobe", ["-v", "error", "-count_frames", "-select_streams", "v:0", ...shown, file], { encoding: "utf8" }),
  );
  return { pictures: Number(streams[0].nb_read_frames), seconds: Number(format.duration) };
}

// A movie of two hours has three pictures, an hour apart. The measured time ends when the server starts to draw,
// because the duration of drawing depends on the machine.
async function assertTwoHourMovie(how, ask) {
  const coming = page.waitForEvent("download");
  await holdingMovie(page, () =>
    timed(`make a movie of the next two hours, by ${how}`, async () => {
      await ask();
      await page.getByTestId("keep-work").waitFor();
    }),
  );
  const download = await coming;
  assert.match(download.suggestedFilename(), /^run_00.*0600Z\.webm$/);
  const { pictures, seconds } = lengthOf(await download.path());
  assert.equal(pictures, 3);
  assert.ok(Math.abs(seconds - 0.75) < 0.3, `it lasts ${seconds} s`);
  await page.getByTestId("keep-work").waitFor({ state: "detached" });
}

async function assertTwoHoursAsked() {
  assert.match(await chosen("movie-from"), /06:00Z/);
  assert.match(await chosen("movie-to"), /08:00Z/);
  assert.match(await text("movie-length"), /^3 pictures/);
}

test("make a movie of the next two hours, by mouse", async () => {
  await assertTwoHourMovie("mouse", async () => {
    await changing(() => page.getByTestId("step-back").click(), page);
    await openPanel(page, "keep");
    await page.getByTestId("keep-movie").locator("summary").click();
    await assertTwoHoursAsked();
    await page.getByTestId("save-movie").click();
  });
  await openPanel(page, "keep");
  await changing(() => page.getByTestId("step-forward").click(), page);
});

test("make a movie of the next two hours, by keys alone", async () => {
  await assertTwoHourMovie("keys", async () => {
    await changing(() => key(","), page);
    await key("s");
    await tabTo(page, "keep-movie");
    await key("Enter");
    await assertTwoHoursAsked();
    await tabTo(page, "save-movie");
    await key("Enter");
  });
  await key("Escape");
  await changing(() => key("."), page);
});

test("a link to a view outlives the session that it was made in", async () => {
  await openPanel(page, "keep");
  await page.getByTestId("keep-scene").locator("summary").click();
  await page.evaluate(() => navigator.clipboard.writeText(""));
  const link = await copied(() => page.getByTestId("keep-link").click());
  await page.keyboard.press("Escape");
  const { data: here, picture } = await grabRestingFrame(page);
  await openPanel(page, "share");
  await page.getByTestId("end-session").click();
  await page.getByTestId("end-session").click();
  await page.getByTestId("open-new").waitFor();
  const context = await browser.newContext(WINDOW);
  const colleague = await context.newPage();
  await colleague.goto(link);
  const { data: there, picture: theirs } = await grabRestingFrame(colleague);
  assert.deepEqual([there.azimuth, there.distance, there.time], [here.azimuth, here.distance, here.time]);
  assert.ok(difference(picture, theirs) < 1, "the pictures differ");
  await context.close();
});

// Starts a server with a run that has geographical coordinates.
async function startPlace() {
  const data = join(folder, "place");
  mkdirSync(data);
  const [began, valid] = ["2020-05-20_00:00:00", "2020-05-20_08:00:00"];
  writeFileSync(join(data, `wrfout_d01_${valid}`), runFile(began, valid, RUNS[1].radiusM, { hasPlace: true }));
  return startServer({ httpPort: await freePort(), grpcPort: await freePort(), data });
}

async function withPlace(look, prepare) {
  placeServer ??= await startPlace();
  const opened = await visit(placeServer.url, prepare);
  await look(opened);
  await opened.context().close();
}

// Checks that the element's words are on the screen, neither cut nor covered.
async function assertIsWhole(opened, name) {
  const words = opened.getByTestId(name);
  await words.waitFor();
  const { cut, right } = await words.evaluate((element) => ({
    cut: element.scrollWidth > element.clientWidth + 1 && getComputedStyle(element).display !== "inline",
    right: element.getBoundingClientRect().right,
  }));
  const next = await opened.locator(".top-buttons").boundingBox();
  assert.ok(!cut && right <= next.x, `${name} is cut, or ends at ${right} of ${next.x} pixels`);
}

test("a run with a place: local time, borders on the map, latitude and longitude under the probe", async () => {
  await withPlace(async (opened) => {
    await openTool(opened, "map");
    const border = opened.locator("[data-testid=map-lines] .map-countries");
    await border.waitFor({ state: "attached" });
    // The border runs from south to north through the middle of the map.
    const middle = () =>
      border.evaluate((path) => {
        const [line, map] = [path, path.ownerSVGElement].map((each) => each.getBoundingClientRect());
        return { right: (line.x + line.width / 2 - map.x) / map.width, high: line.height / map.height };
      });
    const { right, high } = await middle();
    assert.ok(Math.abs(right - 0.5) < 0.1, `the border is at ${right} of the map's width`);
    assert.ok(high > 0.5, `the border is as high as ${high} of the map`);
    await screenshot("questions-place", opened);
    assert.match(await opened.getByTestId("top-time").innerText(), /08:00Z/);
    // The storm has only one time. Its tick must be at the position of the slider's thumb.
    const [ticks, tick] = await Promise.all([".ticks >> nth=0", ".tick"].map((each) => opened.locator(each).boundingBox()));
    assert.ok(Math.abs(tick.x + tick.width / 2 - ticks.x) < 2, `the tick is at ${tick.x}, the line begins at ${ticks.x}`);
    assert.match(await opened.getByTestId("local-time").innerText(), /10:00/);
    await openTool(opened, undefined);
    for (const width of [1240, 900]) {
      await opened.setViewportSize({ width, height: VIEWPORT.height });
      for (const name of ["run", "top-time", "local-time"]) await assertIsWhole(opened, name);
      await screenshot(`questions-place-${width}`, opened);
    }
    await opened.setViewportSize(VIEWPORT);
    await openTool(opened, "probe");
    await opened.getByTestId("probe-middle").click();
    const place = opened.getByTestId("probe-place");
    await place.waitFor();
    const [, latitude, longitude] = /([\d.]+)° N ([\d.]+)° E/.exec(await place.innerText());
    assert.ok(Math.abs(Number(latitude) - PLACE.latitudeDeg) < 0.05, `it is at ${latitude}° N`);
    assert.ok(Math.abs(Number(longitude) - PLACE.longitudeDeg) < 0.05, `it is at ${longitude}° E`);
  });
});

test("at night the page says why the picture is dark, and shows the storm by day", async () => {
  await withPlace(async (opened) => {
    const brightness = async () => {
      return boxMean((await grabRestingFrame(opened)).picture, [0.3, 0.2, 0.7, 0.8]);
    };
    const night = opened.getByTestId("night");
    assert.ok((await brightness()) > 30, "it is day at 10:00");
    assert.equal(await night.count(), 0);
    await openTool(opened, "light");
    await changing(() => opened.getByTestId("day-clock").fill("01:30"), opened);
    await night.waitFor();
    assert.match(await night.innerText(), /It is night at the storm: the sun is 4\d° below the horizon/);
    assert.ok((await brightness()) < 5, "nights are dark");
    await screenshot("questions-night", opened);
    await changing(() => opened.getByTestId("show-by-day").click(), opened);
    await night.waitFor({ state: "detached" });
    assert.ok((await brightness()) > 30, "it is shown by day");
    await screenshot("questions-by-day", opened);
  });
});

test("no error reached the browser's console", () => {
  assert.deepEqual(complaints, []);
});

test("a part of the page that is gone from the server is told", async () => {
  const isGone = (opened) =>
    opened.route(/uPlot|map_lines|every_setting/, (route) => route.fulfill({ status: 404 }));
  await withPlace(async (opened) => {
    const notices = opened.getByTestId("notices");
    const isTold = (words) => until(words, async () => (await notices.innerText()).includes(words));
    await openTool(opened, "map");
    await isTold("The map's coasts and borders could not be loaded. Reload the page");
    await openTool(opened, "probe");
    await opened.getByTestId("probe-middle").click();
    await isTold("The chart could not be loaded");
    assert.match(await opened.getByTestId("probe-found").innerText(), /above sea/, "the table has what the chart shows");
    await openPanel(opened, "drawer");
    await isTold("Every setting could not be loaded");
    await screenshot("questions-parts-gone", opened);
  }, isGone);
});
