// End-to-end tests of the tools: a forecaster's questions, answered by mouse and by keyboard alone, on the real server
// and sample.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { PNG } from "pngjs";
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
  passTime,
  rested,
  restedAndFits,
  screenshot,
  setNumber,
  tabTo,
  timed,
  until,
} from "./driver.mjs";
import { blockDifference, difference, grabCanvas, greyShare, shareOfChange, spread } from "./pictures.mjs";
import { BINARY, freePort, startServer } from "./server_process.mjs";

const SAMPLE = fileURLToPath(new URL("../../samples/supercell.nc", import.meta.url));
// With this window and an open tool, the picture has an even width and height, as movies must have.
const VIEWPORT = { width: 1002, height: 620 };
// Pictures have a quarter of the window's pixels: they cost less, and the page's layout is the same.
const WINDOW = { viewport: VIEWPORT };
// Longer than the time within which the page treats several changes as one step of undo
// (client-web/src/core/history.ts).
const GESTURE_MS = 1000;
const complaints = [];
let folder;
let server;
let browser;
let context;
let page;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "thunderhead-tools-"));
  server = await startServer({
    httpPort: await freePort(),
    grpcPort: await freePort(),
    state: folder,
  });
  browser = await launchBrowser();
  context = await browser.newContext({ ...WINDOW, acceptDownloads: true });
  page = await context.newPage();
  listenForErrors(page, complaints);
  await page.goto(server.url);
  // The tests use the quality Fast, because pictures of the default quality change while they rest.
  await openTool(page, "look");
  await chooseQuality(page, "Fast");
  await rested(page);
  await openTool(page, undefined);
});

after(async () => {
  await browser?.close();
  await server?.stop();
  rmSync(folder, { recursive: true, force: true });
});

// Returns the text of an element on the screen. It waits until the element is visible, because hidden elements' texts
// could be read too.
async function text(id) {
  const shown = page.getByTestId(id);
  await shown.waitFor({ state: "visible" });
  return shown.innerText();
}

const key = (name) => page.keyboard.press(name);
const focusPicture = () => page.getByTestId("storm-canvas").focus();

// Focuses the picture by keyboard alone.
const toPicture = () => tabTo(page, "storm-canvas");

const degreesOnHorizon = () =>
  page
    .locator("[data-testid=annotations] text")
    .evaluateAll((texts) => texts.map(({ textContent }) => textContent).filter((each) => /^(\d{3}°|[NESW]{1,2})$/.test(each)));

// The program's own description of the file, to compare the page with.
const inspected = JSON.parse(execFileSync(BINARY, ["inspect", "--json", SAMPLE], { encoding: "utf8" }));
const maximumOf = (name) =>
  1000 * inspected.fields.find(({ hydrometeor }) => hydrometeor === `HYDROMETEOR_${name}`).maximum;

// Returns the maximum in g/kg at the newest time, as found by another netCDF reader.
function independentMaximum(variable) {
  const script = "import netCDF4, sys; print(1000 * float(netCDF4.Dataset(sys.argv[1])[sys.argv[2]][-1].max()))";
  return Number(execFileSync("/usr/bin/python3", ["-c", script, SAMPLE, variable], { encoding: "utf8" }));
}

test("which run and valid time is this: they stand in the bar, and under Time by its key", async () => {
  await timed("which run and valid time is this", async () => {
    assert.match(await text("storms"), /supercell/);
    assert.match(await text("top-time"), /01:20Z/);
    assert.match(await text("top-time"), /\+1 h 20 min/);
    await key("t");
    assert.match(await text("time-facts"), /Valid\s+day 1 01:20Z[\s\S]*Run\s+run 00:00Z[\s\S]*Lead time\s+\+1 h 20 min/);
  });
  await key("Escape");
});

test("where is the graupel core and how much is there, by keys alone", async () => {
  const { core, row } = await timed("where is the graupel core and how much is there", async () => {
    await key("p");
    await page.getByTestId("core-graupel").waitFor();
    const said = Number(/Graupel ([\d.]+) g\/kg/.exec(await text("core-graupel"))[1]);
    await tabTo(page, "core-graupel");
    await changing(() => key("Enter"), page);
    await toPicture();
    await key("Enter");
    await page.getByTestId("probe-graupel").waitFor();
    return { core: said, row: await text("probe-graupel") };
  });
  assert.ok(Math.abs(maximumOf("GRAUPEL") / independentMaximum("QGRAUP") - 1) < 1e-5, "another reader finds another core");
  // The page converts values back to mixing ratios with the mean air density of a block of cells. The error is at most
  // 9 % (decision 47).
  assert.ok(Math.abs(core / maximumOf("GRAUPEL") - 1) < 0.1, `the page says ${core}, the file has ${maximumOf("GRAUPEL")}`);
  const along = Number(/([\d.]+) g\/kg/.exec(row)[1]);
  assert.ok(along > 0.8 * core && along < 1.01 * core, `along the ray through the core there are ${along} of ${core} g/kg`);
  assert.match(await text("probe-found"), /Cloud\s+[\d.]+ k?m above sea · [\d.]+ km away/);
  assert.match(await text("probe-depth"), /Optical depth [\d.]+/);
  await page.locator("[data-testid=ray-chart] canvas").waitFor();
  await screenshot("tools-probe", page);
});

test("a second click measures from the first", async () => {
  await page.getByTestId("probe-forget").click();
  const middle = { x: VIEWPORT.width / 2, y: VIEWPORT.height / 2 };
  await page.mouse.click(middle.x, middle.y);
  await page.getByTestId("probe-found").waitFor();
  const first = await text("probe-found");
  await page.mouse.click(middle.x + 80, middle.y);
  await page.getByTestId("probe-displacement").waitFor();
  assert.match(await text("probe-displacement"), /From the first click: [\d.]+ k?m to [NESW]+ \(\d+°\), [\d.]+ k?m (lower|higher)/);
  assert.notEqual(await text("probe-found"), first);
  await focusPicture();
  await key("Escape");
});

// Checks that the part above the horizon, which is three quarters down in a spotter's picture, contains cloud with
// light and shade. A clear sky would be blue, and a wall of haze even.
function assertShowsStorm({ data, width, height }) {
  const rows = Math.floor(0.7 * height);
  const sky = { data: data.subarray(0, 4 * width * rows), width, height: rows };
  const [{ deviation }, cloud] = [spread(sky), greyShare(sky, 40)];
  console.log(`above the horizon: brightness varies by ${deviation.toFixed(1)}, ${cloud.toFixed(2)} is cloud`);
  assert.ok(deviation > 8, `its brightness varies by ${deviation} only`);
  assert.ok(cloud > 0.3, `${cloud} of it is cloud`);
}

const chosenOf = () => page.getByTestId("stand-of").evaluate((list) => list.selectedOptions[0].label);

test("from a place 20 km south-east of the core at 18:30 local time, by keys alone", async () => {
  await toPicture();
  await key("Home");
  await rested(page);
  const degrees = await timed("from an airport 20 km south-east of the core at 18:30", async () => {
    await key("m");
    await tabTo(page, "stand-off");
    await key("Enter");
    await tabTo(page, "stand-distance");
    await key("Control+a");
    await page.keyboard.type("20");
    await tabTo(page, "stand-of");
    for (let presses = 0; presses < 10 && !/graupel core/.test(await chosenOf()); presses += 1) await key("ArrowDown");
    assert.match(await chosenOf(), /graupel core/);
    await tabTo(page, "stand-there");
    await changing(() => key("Enter"), page);
    assert.equal((await canvasData(page)).camera, "spotter");
    assert.match(await text("camera"), /Looks to NW \(315°\)/);
    const seen = await degreesOnHorizon();
    await key("l");
    const sun = await text("sun-in-words");
    await tabTo(page, "day-clock");
    await changing(() => page.keyboard.type("0630PM"), page);
    await key("Tab");
    await until("the evening sun", async () => (await text("sun-in-words")) !== sun);
    await rested(page);
    return seen;
  });
  assert.ok(degrees.includes("310°") && degrees.includes("320°"), `on the horizon: ${degrees}`);
  assert.equal(await page.getByTestId("day-clock").inputValue(), "18:30");
  await until("the sun of half past six", async () => /in W(NW)?, \d\d° high/.test(await text("sun-in-words")));
  const { picture } = await grabRestingFrame(page);
  await screenshot("tools-airport", page);
  assertShowsStorm(picture);
  await key("Escape");
});

test("turning the head moves the degrees on the horizon", async () => {
  await toPicture();
  const before = await degreesOnHorizon();
  await changing(async () => {
    for (let i = 0; i < 10; i += 1) await key("ArrowRight");
  }, page);
  assert.notDeepEqual(await degreesOnHorizon(), before);
  const words = await page.getByTestId("storm-canvas").getAttribute("aria-label");
  assert.match(words, /^supercell .*, day 1 01:20Z\. Looks to NNW \(345°\).* from [\d.]+ km [NESW]+ of the middle\. The sun is in W, 2\d° high$/);
});

test("a click on the map stands there, a drag from there looks, a double click turns around that place", async () => {
  await openTool(page, "map");
  const map = page.getByTestId("inset-map");
  await map.scrollIntoViewIfNeeded();
  const { x, y, width, height } = await map.boundingBox();
  const before = await degreesOnHorizon();
  await changing(() => page.mouse.click(x + 0.3 * width, y + 0.75 * height), page);
  assert.equal((await canvasData(page)).camera, "spotter");
  const degrees = await degreesOnHorizon();
  assert.ok(degrees.length >= 3, `on the horizon: ${degrees}`);
  assert.notDeepEqual(degrees, before);
  const camera = await page.getByTestId("map-camera").boundingBox();
  const [aside, down] = [camera.x + camera.width / 2 - (x + 0.3 * width), camera.y + camera.height / 2 - (y + 0.75 * height)];
  assert.ok(Math.hypot(aside, down) < 8, `the camera is ${aside}, ${down} pixels from where the click was`);
  const scale = await page.getByTestId("map-scale").boundingBox();
  assert.ok(scale.x > x + width / 2, "the scale bar makes way for the camera");
  // A drag turns the camera towards the point where the drag ends. Here this point is west of the camera.
  const stands = { x: x + 0.3 * width, y: y + 0.75 * height };
  await changing(() => dragBetween(page, stands, { x: stands.x - 0.2 * width, y: stands.y }), page);
  await until("the view to the west", async () => /Looks to W \(2(6[5-9]|7[0-5])°\)/.test(await text("camera")));
  await until("degrees to the west", async () => (await degreesOnHorizon()).includes("W"));
  assert.deepEqual((await degreesOnHorizon()).filter((each) => degrees.includes(each)), []);
  await changing(() => atOneMoment(page, () => page.mouse.dblclick(x + 0.5 * width, y + 0.4 * height)), page);
  assert.equal((await canvasData(page)).camera, "orbit");
  await screenshot("tools-map", page);
});

// Returns the middle of a map element in shares of the storm's domain. The map shows more than the domain if the camera
// is outside the domain.
async function placeInDomain(selector) {
  const [domain, box] = await Promise.all(
    [".map-domain", selector].map((each) => page.locator(`[data-testid=inset-map] ${each}`).boundingBox()),
  );
  return [(box.x + box.width / 2 - domain.x) / domain.width, (box.y + box.height / 2 - domain.y) / domain.height];
}

async function assertIsAt(selector, [right, down]) {
  const [x, y] = await placeInDomain(selector);
  assert.ok(Math.hypot(x - right, y - down) < 0.02, `${selector} is at ${x}, ${y} of the domain, not at ${right}, ${down}`);
}

test("keys on the map move a cross, stand there, and turn around that place", async () => {
  await openTool(page, undefined);
  await key("m");
  await tabTo(page, "inset-map");
  // The cross is in the middle at first.
  await changing(() => key("Enter"), page);
  for (let presses = 0; presses < 8; presses += 1) await key("ArrowRight");
  await key("Shift+ArrowDown");
  const stand = await placeInDomain(".map-cross");
  assert.ok(stand[0] > 0.65 && stand[1] > 0.55, `the cross is at ${stand} of the domain`);
  await changing(() => key("Enter"), page);
  assert.equal((await canvasData(page)).camera, "spotter");
  await assertIsAt(".map-camera", stand);
  for (let presses = 0; presses < 8; presses += 1) await key("ArrowLeft");
  const middle = await placeInDomain(".map-cross");
  await changing(() => key("o"), page);
  assert.equal((await canvasData(page)).camera, "orbit");
  await assertIsAt(".map-target", middle);
});

test("a view is kept with a name, and comes back", async () => {
  const before = await canvasData(page);
  await page.getByTestId("keep-view").click();
  await page.getByTestId("view-name").fill("Inflow");
  await page.keyboard.press("Enter");
  await changing(() => page.getByTestId("camera-kind").getByText("From above").click(), page);
  assert.equal((await canvasData(page)).camera, "topDown");
  assert.ok((await page.locator("[data-testid=annotations]").innerHTML()).includes(" km<"), "there is no scale bar");
  await changing(() => page.getByTestId("named-view").click(), page);
  const after = await canvasData(page);
  assert.deepEqual([after.camera, after.azimuth, after.distance], [before.camera, before.azimuth, before.distance]);
  await openTool(page, undefined);
});

test("how wrong is this picture: it says so over it", async () => {
  await timed("how wrong is this picture, at a glance", () =>
    until("an error in the line over the picture", async () =>
      /This picture is [\d.]+ % off/.test((await text("error-line")).replaceAll("\n", " ")),
    ),
  );
  const source = page.getByTestId("error-source");
  // The error is measured with the computing time that the machine has left, which may be little.
  const measured = async () => /^measured: [\d.]+ to [\d.]+ %$/.test(await source.innerText());
  await until("the error to be measured while the picture rests", measured);
  await timed("how wrong is this picture, as measured", async () => {
    await key("k");
    await tabTo(page, "accuracy-section");
    await key("Enter");
    await until("the same error in the report", async () => {
      const [line, report] = [await text("error-line"), await text("accuracy-report")];
      return /([\d.]+) %/.exec(line)[1] === /Measured error ([\d.]+) %/.exec(report)?.[1];
    });
  });
  await key("Escape");
});

test("Ctrl+Z takes a change back, Ctrl+Y does it again", async () => {
  await openTool(page, "look");
  const exposure = () => page.getByTestId("exposure-number").inputValue();
  const automatic = page.getByTestId("automatic-exposure");
  assert.ok(await automatic.isChecked());
  // Changes that closely follow each other are undone together, so the page's clock advances before each change.
  await passTime(page, GESTURE_MS);
  await changing(() => setNumber(page, "exposure", 1.5), page);
  await passTime(page, GESTURE_MS);
  await changing(() => setNumber(page, "exposure", -1), page);
  await focusPicture();
  await changing(() => key("Control+z"), page);
  assert.equal(await exposure(), "1.5");
  await changing(() => key("Control+y"), page);
  assert.equal(await exposure(), "-1");
  await changing(() => key("Control+z"), page);
  assert.equal(await exposure(), "1.5");
  // Undoes back to the scene that the other tests expect.
  await changing(() => key("Control+z"), page);
  assert.ok(await automatic.isChecked());
  await openTool(page, undefined);
});

test("every setting is found by its name, with its meaning, and can be set", async () => {
  await focusPicture();
  await key("x");
  await page.getByTestId("drawer-search").waitFor();
  await page.keyboard.type("ground_albedo");
  const setting = page.getByTestId("setting-sky.ground_albedo-number");
  await setting.waitFor();
  assert.match(await text("drawer"), /Diffuse reflectance of the ground/);
  assert.match(await text("drawer"), /0 to 1, default 0.2/);
  await changing(() => setNumber(page, "setting-sky.ground_albedo", 0.6), page);
  await changing(() => setNumber(page, "setting-sky.ground_albedo", 0.2), page);
  await page.getByTestId("drawer-search").fill("no such thing");
  await page.getByText("No setting has such a name.").waitFor();
  await focusPicture();
  await key("Escape");
  assert.equal(await page.getByTestId("drawer").isVisible(), false);
});

let saved;
// The movie has the window's aspect ratio.
const MOVIE = { width: 400, height: 248 };

const flipped = ({ data, width, height }) => {
  const turned = { data: Buffer.alloc(data.length), width, height };
  for (let y = 0; y < height; y += 1)
    for (let x = 0; x < width; x += 1) data.copy(turned.data, 4 * (y * width + width - 1 - x), 4 * (y * width + x), 4 * (y * width + x + 1));
  return turned;
};

// Checks that two pictures have the same colours. Letters and scales over one of the pictures do not matter, because
// they increase the difference from the view and the difference from its mirror image equally.
function assertSameColours(picture, view, what) {
  const [apart, mirrored] = [blockDifference(picture, view), blockDifference(flipped(picture), view)];
  console.log(`${what}: ${apart.toFixed(2)} from the view, its mirror image ${mirrored.toFixed(2)}`);
  assert.ok(apart < 4 && mirrored > apart + 2, `${what} differs from the view by ${apart}, its mirror image by ${mirrored}`);
}

const ffmpeg = (...args) => execFileSync("ffmpeg", ["-v", "error", "-y", ...args]);

// Returns one picture of a movie. `number` counts the pictures from 0.
function pictureOf(file, number) {
  const picture = join(folder, `picture-${number}.png`);
  ffmpeg("-i", file, "-vf", `select=eq(n\\,${number})`, "-frames:v", "1", picture);
  return PNG.sync.read(readFileSync(picture));
}

// Compares the last picture of a movie with the view scaled down to its size.
function assertLastPictureIs(view, file) {
  const canvas = join(folder, "canvas.png");
  writeFileSync(canvas, PNG.sync.write(view));
  ffmpeg("-i", canvas, "-vf", `scale=${MOVIE.width}:${MOVIE.height}`, `${canvas}.small.png`);
  assertSameColours(pictureOf(file, 3), PNG.sync.read(readFileSync(`${canvas}.small.png`)), "the movie's last picture");
}

test("a picture is saved, and dropped on a fresh page it brings the same view", async () => {
  await restedAndFits(page);
  await openPanel(page, "keep");
  const coming = page.waitForEvent("download");
  await page.getByTestId("save-picture").click();
  const download = await coming;
  assert.match(download.suggestedFilename(), /^supercell-.*\.png$/);
  saved = readFileSync(await download.path());
  assert.ok(saved.includes("thunderhead.scene"));
  await page.keyboard.press("Escape");
  assertSameColours(PNG.sync.read(saved), (await grabRestingFrame(page)).picture, "the saved picture");
  const fresh = await (await browser.newContext(WINDOW)).newPage();
  listenForErrors(fresh, complaints);
  try {
    await fresh.goto(server.url);
    await until("the fresh page's picture", async () => (await canvasData(fresh)).refined === "true");
    await changing(
      () =>
        fresh.evaluate((base64) => {
          const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
          const data = new DataTransfer();
          data.items.add(new File([bytes], "saved.png", { type: "image/png" }));
          window.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
        }, saved.toString("base64")),
      fresh,
    );
    await until("the same view", async () => {
      const [there, here] = await Promise.all([canvasData(fresh), canvasData(page)]);
      return there.azimuth === here.azimuth && there.distance === here.distance && there.refined === "true";
    });
    const [there, here] = [await grabRestingFrame(fresh), await grabRestingFrame(page)];
    const apart = difference(here.picture, there.picture);
    assert.ok(apart < 1, `the pictures differ by ${apart}: ${JSON.stringify([there.data, here.data])}`);
  } finally {
    await fresh.context().close();
  }
});

test("a file that is no scene is refused where it was opened", async () => {
  await openPanel(page, "keep");
  await page.getByTestId("keep-scene").locator("summary").click();
  await page.getByTestId("file").setInputFiles({ name: "notes.json", mimeType: "application/json", buffer: Buffer.from("[]") });
  assert.match(await text("keep-refused"), /^notes.json cannot be opened: ./i);
  assert.equal(await page.locator("[data-testid=keep-scene] [data-testid=keep-refused]").count(), 1);
  assert.equal(await page.getByTestId("notices").innerText(), "");
  await page.getByTestId("keep-scene").locator("summary").click();
  await page.keyboard.press("Escape");
  // A file that is dropped on the picture and refused shows its error over the picture.
  await page.evaluate(() => {
    const data = new DataTransfer();
    data.items.add(new File(["[]"], "dropped.json", { type: "application/json" }));
    window.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
  });
  await page.getByText("dropped.json cannot be opened").waitFor();
  await page.getByTestId("notices").getByRole("button").click();
});

test("a browser without H.264 says what it puts into an MP4", async () => {
  const other = await (await browser.newContext(WINDOW)).newPage();
  await other.addInitScript(() => {
    const asked = VideoEncoder.isConfigSupported.bind(VideoEncoder);
    VideoEncoder.isConfigSupported = (config) =>
      config.codec.startsWith("avc") ? Promise.resolve({ supported: false, config }) : asked(config);
  });
  try {
    await other.goto(server.url);
    await rested(other);
    await openPanel(other, "keep");
    await other.getByTestId("keep-movie").locator("summary").click();
    assert.equal(await other.getByTestId("movie-codec").count(), 0);
    await other.getByTestId("movie-format").selectOption("mp4");
    assert.match(await other.getByTestId("movie-codec").innerText(), /cannot encode H.264 at this size, so the MP4 file contains VP9/);
  } finally {
    await other.context().close();
  }
});

test("a page without an encoder says at the button that it makes no movie", async () => {
  const other = await (await browser.newContext(WINDOW)).newPage();
  // Browsers also hide VideoEncoder from pages that are loaded by plain HTTP.
  await other.addInitScript(() => delete globalThis.VideoEncoder);
  try {
    await other.goto(server.url);
    await rested(other);
    await openPanel(other, "keep");
    await other.getByTestId("keep-movie").locator("summary").click();
    assert.match(await other.getByTestId("movie-impossible").innerText(), /only on pages loaded by HTTPS or from localhost/);
    assert.equal(await other.getByTestId("save-movie").isDisabled(), true);
    assert.equal(await other.getByTestId("save-picture").isEnabled(), true);
  } finally {
    await other.context().close();
  }
});

async function openMovieForm() {
  await openPanel(page, "keep");
  const section = page.getByTestId("keep-movie");
  if (!(await section.evaluate(({ open }) => open))) await section.locator("summary").click();
}

async function fillMovieForm(format) {
  await openMovieForm();
  assert.match(await text("movie-length"), /^4 pictures, 1 s/);
  await page.getByTestId("movie-size").selectOption("own");
  await page.getByTestId("movie-size-width").fill(String(MOVIE.width));
  await page.getByTestId("movie-size-width").press("Enter");
  await page.getByTestId("movie-size-height").fill(String(MOVIE.height));
  await page.getByTestId("movie-size-height").press("Enter");
  await page.getByTestId("movie-format").selectOption(format);
}

// Returns codec, size and number of pictures of a movie.
function streamOf(file) {
  const shown = ["-show_entries", "stream=codec_name,width,height,nb_read_frames", "-of", "json"];
  const probe = execFileSync("ffprobe", ["-v", "error", "-count_frames", "-select_streams", "v:0", ...shown, file], { encoding: "utf8" });
  const [{ codec_name: codec, width, height, nb_read_frames: pictures }] = JSON.parse(probe).streams;
  return { codec, width, height, pictures: Number(pictures) };
}

async function assertIsTheMovie(download, codec = "vp9") {
  const file = await download.path();
  assert.deepEqual(streamOf(file), { codec, ...MOVIE, pictures: 4 });
  assertLastPictureIs((await grabRestingFrame(page)).picture, file);
}

const rememberedMovie = () => page.evaluate(() => sessionStorage.getItem("thunderhead.movie.supercell") || undefined);

// Returns the movie's codec. The panel shows a note only if this browser cannot write H.264 into an MP4. This function
// asks the browser in the same way as the panel.
async function saidCodec(format) {
  if (format === "webm") return "vp9";
  const encodes = await page.evaluate(async (size) => {
    const config = { codec: "avc1.42001f", ...size, bitrate: 1e6 };
    return (await VideoEncoder.isConfigSupported(config)).supported;
  }, MOVIE);
  await until("what the panel says of the codec", async () => (await page.getByTestId("movie-codec").count()) === (encodes ? 0 : 1));
  return encodes ? "h264" : "vp9";
}

for (const format of ["webm", "mp4"])
  test(`a movie of all times as ${format}, by a job of the server`, async () => {
    await fillMovieForm(format);
    const codec = await saidCodec(format);
    const coming = page.waitForEvent("download");
    await holdingMovie(page, async () => {
      await page.getByTestId("save-movie").click();
      await page.keyboard.press("Escape");
      await page.getByTestId("at-work").waitFor();
    });
    await assertIsTheMovie(await coming, codec);
  });

test("a reload while a movie is made goes on with it, and the next does not make it again", async () => {
  await fillMovieForm("webm");
  const downloads = [];
  page.on("download", (download) => downloads.push(download));
  await holdingMovie(page, async () => {
    await page.getByTestId("save-movie").click();
    await page.keyboard.press("Escape");
    await until("a movie that outlives the page", rememberedMovie);
    assert.equal(downloads.length, 0);
    await page.reload();
    await page.getByTestId("at-work").waitFor();
  });
  await until("the movie", async () => downloads.length > 0);
  await assertIsTheMovie(downloads[0]);
  assert.equal(await rememberedMovie(), undefined);
  await page.reload();
  await restedAndFits(page);
  assert.equal(downloads.length, 1);
  assert.equal(await page.getByTestId("at-work").count(), 0);
  page.removeAllListeners("download");
});

async function makeMovie(pictures) {
  const coming = page.waitForEvent("download");
  await page.getByTestId("save-movie").click();
  const file = await (await coming).path();
  await page.getByTestId("keep-work").waitFor({ state: "detached" });
  assert.equal(streamOf(file).pictures, pictures);
  return file;
}

test("a movie begins at the time shown, unless the newest is, and ends where it is told", async () => {
  // The view shows the whole storm, which changes so much between two times that the pictures of both can be told
  // apart.
  await openTool(page, "map");
  await changing(() => page.getByTestId("home").click(), page);
  const newest = await page.getByTestId("time").inputValue();
  await changing(() => page.getByTestId("time").fill("1"), page);
  await openMovieForm();
  assert.match(await text("movie-length"), /^3 pictures/);
  assert.equal(await page.getByTestId("movie-from").inputValue(), "1");
  await page.getByTestId("movie-to").selectOption("0");
  assert.match(await text("movie-length"), /^2 pictures/);
  const backwards = await makeMovie(2);
  await key("Escape");
  const from = (await grabRestingFrame(page)).picture;
  await changing(() => page.getByTestId("time").fill("0"), page);
  const to = (await grabRestingFrame(page)).picture;
  const shares = [0, 1].map((number) => shareOfChange(pictureOf(backwards, number), from, to));
  console.log(`the movie's pictures show ${shares.map((share) => share.toFixed(2)).join(" and ")} of the change between the views`);
  assert.ok(Math.abs(shares[0]) < 0.3, `the first picture shows ${shares[0]} of the change`);
  assert.ok(Math.abs(shares[1] - 1) < 0.3, `the last picture shows ${shares[1]} of the change`);
  await changing(() => page.getByTestId("time").fill(newest), page);
});

test("a movie goes from one named view to another", async () => {
  await openTool(page, "map");
  const before = await canvasData(page);
  await page.getByTestId("camera-kind").getByText("From above").click();
  await until("the view from above", async () => (await canvasData(page)).camera === "topDown");
  await page.getByTestId("keep-view").click();
  await page.getByTestId("view-name").fill("Above");
  await page.keyboard.press("Enter");
  await until("two views", async () => (await page.getByTestId("named-view").count()) === 2);
  await openMovieForm();
  await page.getByTestId("movie-along-views").check();
  await page.getByTestId("movie-per-view").fill("2");
  await page.getByTestId("movie-per-view").press("Enter");
  assert.match(await text("movie-length"), /^3 pictures/);
  const file = await makeMovie(3);
  await page.getByTestId("movie-along-views").uncheck();
  await key("Escape");
  assert.ok(difference(pictureOf(file, 0), pictureOf(file, 2)) > 5, "it ends where it began");
  await page.getByTestId("named-view").first().click();
  await until("the view as before", async () => (await canvasData(page)).camera === before.camera);
  await openTool(page, undefined);
});

test("a movie that is cancelled is neither saved nor made again", async () => {
  const downloads = [];
  page.on("download", (download) => downloads.push(download));
  await openMovieForm();
  await holdingMovie(page, async () => {
    await page.getByTestId("save-movie").click();
    await until("the job", rememberedMovie);
    await page.getByTestId("keep-cancel").click();
    await page.getByTestId("keep-work").waitFor({ state: "detached" });
    await until("the job to be given up", async () => (await rememberedMovie()) === undefined);
  });
  assert.equal(await page.getByTestId("save-movie").isEnabled(), true);
  await key("Escape");
  await page.reload();
  await restedAndFits(page);
  assert.equal(await page.getByTestId("at-work").count(), 0);
  assert.equal(downloads.length, 0);
  page.removeAllListeners("download");
});

// Returns the window position at these shares of a canvas's width and height.
async function placeOn(canvas, right, down) {
  const { x, y, width, height } = await canvas.boundingBox();
  return [x + right * width, y + down * height];
}

// Compares values along the rays of two clicks that may be half a pixel apart.
function assertNearlySame(one, other) {
  const [these, those] = [one, other].map((words) => words.replace(/ away–.*/, "").match(/\d[\d.]*/g).map(Number));
  assert.equal(these.length, those.length, `${one}; ${other}`);
  these.forEach((value, at) => {
    const apart = Math.abs(value - those[at]) / Math.max(value, those[at], 1e-9);
    assert.ok(apart < 0.2, `${value} and ${those[at]} in ${one}; ${other}`);
  });
}

// Checks that the probe over B shows B's time: the same values as those of A once A shows it.
async function assertProbesB(compared) {
  const found = async (canvas) => {
    const before = await page.getByTestId("probe-found").allInnerTexts();
    await page.mouse.click(...(await placeOn(canvas, 0.76, 0.5)));
    await until("the probe", async () => {
      const now = await page.getByTestId("probe-found").allInnerTexts();
      return now.length > 0 && now[0] !== before[0];
    });
    return (await text("probe-found")).replace(/From the first click: .*/, "").replace(/\s+/g, " ");
  };
  const canvas = page.getByTestId("storm-canvas");
  await openTool(page, "probe");
  await restedAndFits(page);
  await restedAndFits(page, "compared-canvas");
  const ofA = await found(canvas);
  assert.equal(await page.getByTestId("probe-picture").count(), 0);
  const ofB = await found(compared);
  assert.match(ofB, /^B · /);
  assert.throws(() => assertNearlySame(ofA, ofB), "at another time the values differ");
  await screenshot("tools-compare-probe", page);
  const shown = await page.getByTestId("time").inputValue();
  await page.getByTestId("time").fill("0");
  await until("A's time", async () => (await canvasData(page)).time === "0");
  await restedAndFits(page);
  assertNearlySame(await found(canvas), ofB);
  await page.getByTestId("time").fill(shown);
  await until("A's time again", async () => (await canvasData(page)).time === shown);
  await openTool(page, undefined);
}

// Checks that a line drawn over picture B appears at the same place of picture A, because other viewers see only A.
async function assertPenOverBDrawsOnA(compared) {
  await openTool(page, "marks");
  await page.getByTestId("tool-pen").click();
  await restedAndFits(page);
  const marks = page.getByTestId("mark");
  const before = await marks.count();
  await page.mouse.move(...(await placeOn(compared, 0.4, 0.5)));
  await page.mouse.down();
  await page.mouse.move(...(await placeOn(compared, 0.6, 0.5)), { steps: 6 });
  await page.mouse.up();
  await until("the mark", async () => (await marks.count()) === before + 1);
  const canvas = page.getByTestId("storm-canvas");
  const [[left], [right]] = [await placeOn(canvas, 0.4, 0.5), await placeOn(canvas, 0.6, 0.5)];
  const corners = (await marks.last().evaluate(({ dataset }) => dataset.corners)).split(" ");
  const xs = corners.map((corner) => Number(corner.split(",")[0]));
  assert.ok(Math.abs(Math.min(...xs) - left) < 3, `the line begins at ${Math.min(...xs)}, not at ${left}`);
  assert.ok(Math.abs(Math.max(...xs) - right) < 3, `the line ends at ${Math.max(...xs)}, not at ${right}`);
  await page.getByTestId("clear-marks").click();
  await until("no mark more", async () => (await marks.count()) === before);
  await key("Escape");
  await openTool(page, undefined);
}

test("two times are compared with one camera", async () => {
  await openPanel(page, "compare");
  await page.getByTestId("compare-time").selectOption("0");
  await page.keyboard.press("Escape");
  const compared = page.getByTestId("compared-canvas");
  await restedAndFits(page, "compared-canvas");
  assert.match(await text("name-b"), /B · day 1 00:20Z/);
  const grab = async () => {
    const url = await compared.evaluate((canvas) => canvas.toDataURL("image/png"));
    return PNG.sync.read(Buffer.from(url.split(",")[1], "base64"));
  };
  const before = await grab();
  assert.ok(difference(await grabCanvas(page), before) > 0.3, "B looks like A");
  const { revision } = await canvasData(page, "compared-canvas");
  const start = { x: 300, y: 300 };
  await changing(() => dragBetween(page, start, { x: start.x + 90, y: start.y }), page);
  assert.ok(Number((await restedAndFits(page, "compared-canvas")).revision) > Number(revision), "B turned too");
  assert.ok(difference(before, await grab()) > 0.3, "B's camera did not turn");
  await page.getByTestId("swipe").focus();
  await key("ArrowLeft");
  assert.match(await compared.evaluate(({ style }) => style.clipPath), /49%/);
  await screenshot("tools-compare", page);
  await openPanel(page, "compare");
  await page.getByTestId("compare-layout").getByText("Side by side").click();
  await until("side by side", async () => (await compared.boundingBox()).x > 400);
  await key("Escape");
  await restedAndFits(page, "compared-canvas");
  await assertProbesB(compared);
  await assertPenOverBDrawsOnA(compared);
  await openPanel(page, "compare");
  await page.getByTestId("compare-end").click();
  await page.keyboard.press("Escape");
  assert.equal(await compared.count(), 0);
  await rested(page);
});

test("an arrow, words and a ring are put on the storm by keys alone", async () => {
  await key("d");
  for (const [tool, count] of [
    ["pen", 1],
    ["arrow", 2],
    ["text", 3],
  ]) {
    await tabTo(page, `tool-${tool}`);
    await key("Enter");
    if (tool === "text") {
      await tabTo(page, "mark-words");
      await page.keyboard.type("HAIL 2 CM");
    }
    await tabTo(page, "mark-middle");
    await key("Enter");
    await until(`mark ${count}`, async () => (await page.getByTestId("mark").count()) === count);
  }
  await screenshot("tools-marks", page);
});

// Returns the share of the marks' corners around which the picture has a pixel of the mark's colour.
async function markedShare({ data, width, height }) {
  const box = await page.getByTestId("storm-canvas").boundingBox();
  const marks = await page.getByTestId("mark").evaluateAll((groups) =>
    groups.map((group) => [getComputedStyle(group).color, group.dataset.corners]),
  );
  const corners = marks.flatMap(([color, places]) => {
    const rgb = color.match(/\d+/g).map(Number);
    return places.split(" ").map((place) => ({ rgb, place: place.split(",").map(Number) }));
  });
  const isMarked = ({ rgb, place: [left, top] }) => {
    const [x, y] = [Math.round(((left - box.x) * width) / box.width), Math.round(((top - box.y) * height) / box.height)];
    for (let row = y - 2; row <= y + 2; row += 1)
      for (let column = x - 2; column <= x + 2; column += 1)
        if (rgb.every((each, i) => Math.abs(data[4 * (row * width + column) + i] - each) < 40)) return true;
    return false;
  };
  assert.ok(corners.length > 60, `the marks have ${corners.length} corners`);
  return corners.filter(isMarked).length / corners.length;
}

async function savePicture() {
  await openPanel(page, "keep");
  const coming = page.waitForEvent("download");
  await page.getByTestId("save-picture").click();
  const file = readFileSync(await (await coming).path());
  await page.keyboard.press("Escape");
  return file;
}

test("marks are burnt into a picture that is saved, unless they are switched off", async () => {
  const marked = await savePicture();
  assert.ok(marked.includes("thunderhead.scene"));
  writeFileSync(new URL("output/tools-saved-marks.png", import.meta.url), marked);
  const share = await markedShare(PNG.sync.read(marked));
  assert.ok(share > 0.95, `${share} of the marks' corners have their colour`);
  await openTool(page, "look");
  await page.getByTestId("overlay-section").locator("summary").click();
  await page.getByTestId("overlay-marks").uncheck();
  const plain = await markedShare(PNG.sync.read(await savePicture()));
  assert.ok(plain < 0.2, `${plain} of the marks' corners have their colour in a picture without marks`);
  await page.getByTestId("overlay-marks").check();
  await openTool(page, "marks");
});

// Returns the share of a corner's pixels that are as white as letters.
function whiteShare({ data, width }, left, top, right, bottom) {
  let white = 0;
  for (let y = top; y < bottom; y += 1)
    for (let x = left; x < right; x += 1) {
      const at = 4 * (y * width + x);
      if (Math.min(data[at], data[at + 1], data[at + 2]) > 240) white += 1;
    }
  return white / ((right - left) * (bottom - top));
}

test("title and valid time are burnt into a picture that is saved, unless they are switched off", async () => {
  await openTool(page, "look");
  await page.getByTestId("overlay-section").locator("summary").click();
  const corners = async () => {
    const picture = PNG.sync.read(await savePicture());
    const { width, height } = picture;
    return { title: whiteShare(picture, 0, 0, width >> 1, height >> 4), time: whiteShare(picture, 0, height - (height >> 4), width >> 2, height) };
  };
  const both = await corners();
  await page.getByTestId("overlay-title").uncheck();
  const untitled = await corners();
  await page.getByTestId("overlay-time").uncheck();
  const neither = await corners();
  console.log("white of the corners of title and time:", both, untitled, neither);
  assert.ok(both.title > 0.01 && both.time > 0.01, "title and time are in the corners");
  assert.ok(untitled.title < 0.001 && untitled.time > 0.01, "without a title its corner is free, that of the time is not");
  assert.ok(neither.title < 0.001 && neither.time < 0.001, "both corners are free");
  for (const name of ["title", "time"]) await page.getByTestId(`overlay-${name}`).check();
  await openTool(page, "marks");
});

test("marks are erased by keys alone", async () => {
  await tabTo(page, "clear-marks");
  await key("Enter");
  await until("no marks", async () => (await page.getByTestId("mark").count()) === 0);
  await key("Escape");
  await key("Escape");
});

test("lengths are shown in feet and nautical miles on request", async () => {
  await openTool(page, "time");
  await page.getByTestId("units").selectOption("aviation");
  await openTool(page, "map");
  assert.match(await text("camera"), / nm away/);
  await openTool(page, "time");
  await page.getByTestId("units").selectOption("metric");
  await openTool(page, undefined);
});

test("no error reached the browser's console", () => {
  assert.deepEqual(complaints, []);
});
