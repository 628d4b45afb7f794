// End-to-end test of the page: the real server, a real browser, the sample storm. Screenshots go to output/.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { PNG } from "pngjs";
import {
  atOneMoment,
  canvasData as canvasDataOf,
  changing as changingOn,
  chooseQuality as chooseQualityOn,
  dragBetween,
  grabRestingFrame as grabRestingFrameOf,
  launchBrowser,
  listenForErrors,
  openPanel,
  openTool,
  rested as restedOn,
  restedAndFits,
  screenshot as screenshotOf,
  setNumber,
  until,
} from "./driver.mjs";
import { boxMean, differingShare, difference, grabCanvas, greyShare, spread } from "./pictures.mjs";
import { freePort, startServer } from "./server_process.mjs";
import { countSceneUpdates } from "./socket_messages.mjs";

const VIEWPORT = { width: 1100, height: 700 };
// Pictures have a quarter of the window's pixels: they cost less, and the page's layout is the same.
const PIXEL_RATIO = 0.5;

let server;
let ports;
let browser;
let context;
let page;
let sceneUpdates;
const complaints = [];

before(async () => {
  ports = { httpPort: await freePort(), grpcPort: await freePort() };
  server = await startServer(ports);
  browser = await launchBrowser();
  context = await browser.newContext({
    viewport: VIEWPORT,
    deviceScaleFactor: PIXEL_RATIO,
    permissions: ["clipboard-read", "clipboard-write"],
  });
  page = await context.newPage();
  listenForErrors(page, complaints);
  sceneUpdates = countSceneUpdates(page);
  await page.goto(server.url);
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

const canvasData = (of = page) => canvasDataOf(of);
const restingFrame = async () => (await grabRestingFrameOf(page)).picture;
const rested = (of = page) => restedOn(of);
const changing = (action, of = page) => changingOn(action, of);
const screenshot = (name, of = page) => screenshotOf(name, of);

// Runs an action that changes the scene, and returns the final picture of the new scene.
async function restingFrameAfter(action) {
  await changing(action);
  return restingFrame();
}

function drag(rightPx, downPx) {
  const start = { x: VIEWPORT.width * 0.4, y: VIEWPORT.height * 0.5 };
  return dragBetween(page, start, { x: start.x + rightPx, y: start.y + downPx });
}

// Makes a touch gesture: fingers move from the first points to the second.
async function slide(fingers, from, to) {
  const steps = 8;
  const at = (share) =>
    from.map(([x, y], id) => ({
      x: x + share * (to[id][0] - x),
      y: y + share * (to[id][1] - y),
      id,
    }));
  const send = (type, touchPoints) => fingers.send("Input.dispatchTouchEvent", { type, touchPoints });
  await send("touchStart", at(0));
  for (let step = 1; step <= steps; step += 1) await send("touchMove", at(step / steps));
  await send("touchEnd", []);
}

// Switches back to automatic exposure after a value was set.
async function exposeAutomatically(of) {
  await of.getByTestId("automatic-exposure").evaluate((box) => box.click());
}

const tool = (name) => openTool(page, name);

// Returns the name of the chosen quality in the tool Look as a list, which is empty if no quality is chosen.
function chosenQuality(of = page) {
  return of
    .locator("[data-testid=quality-choice] input:checked")
    .evaluateAll((radios) => radios.map((radio) => radio.labels[0].innerText));
}

const chooseQuality = (word) => chooseQualityOn(page, word);

async function unfoldSettings(open = true) {
  await tool("look");
  const settings = page.getByTestId("technique-settings");
  if ((await settings.evaluate((details) => details.open)) !== open) {
    await settings.locator("> summary").click();
  }
}

const foldSettings = () => unfoldSettings(false);

// Waits for a refined picture with more traced paths than `least`, and returns their number.
async function pathsBeyond(least) {
  let paths = 0;
  await until(`more than ${least} traced paths`, async () => {
    const data = await canvasData();
    paths = data.refined === "true" ? Number(data.paths) : 0;
    return paths > least;
  });
  return paths;
}

// The following tests compare pictures in the light of a higher sun behind the camera's left shoulder. The sun
// therefore moves 20 degrees to the south and 17 degrees up.
test("the arrow keys turn the sun on its dome", async () => {
  await rested();
  await tool("light");
  await page.getByTestId("sun-dome").focus();
  await changing(async () => {
    for (let i = 0; i < 4; i += 1) await page.keyboard.press("ArrowLeft");
    for (let i = 0; i < 3; i += 1) await page.keyboard.press("ArrowUp");
    for (let i = 0; i < 2; i += 1) await page.keyboard.press("Shift+ArrowUp");
  });
});

test("the storm's last time is shown first", async () => {
  assert.equal((await rested()).time, "3");
  await changing(() => page.getByTestId("time").fill("0"));
});

test("a storm is on the canvas, not a blank", async () => {
  const picture = await restingFrame();
  await screenshot("1-storm");
  assert.equal(picture.width, PIXEL_RATIO * VIEWPORT.width);
  assert.equal(picture.height, PIXEL_RATIO * VIEWPORT.height);
  const { deviation } = spread(picture);
  assert.ok(deviation > 8, `the picture is nearly uniform: deviation ${deviation}`);
  const grey = greyShare(picture, 60);
  assert.ok(grey > 0.005 && grey < 0.9, `share of bright cloud pixels is ${grey}`);
});

test("a fresh page is balanced: diffusion with detail", async () => {
  await tool("look");
  assert.deepEqual(await chosenQuality(), ["Balanced"]);
  assert.match(await page.getByTestId("quality-choice-about").innerText(), /Fine detail/);
  await unfoldSettings();
  const label = (choice) => choice.evaluate((select) => select.selectedOptions[0].label);
  assert.equal(await page.getByTestId("technique-choice").inputValue(), "light_volume");
  assert.equal(await label(page.getByTestId("technique-transport")), "Diffusion");
  assert.equal(await label(page.getByTestId("technique-traced-light")), "At rest");
  assert.equal(await page.getByTestId("technique-detail").isChecked(), true);
  assert.equal(await page.getByTestId("technique-per-field-phase").isChecked(), true);
  await screenshot("1-settings");
  await foldSettings();
  await tool("fields");
  assert.equal(await page.getByTestId("field-cloud").count(), 1);
  assert.equal(await page.getByTestId("field-cloud-color").count(), 0, "no colours that are not shown");
});

test("path tracing corrects the picture while it rests, and stays when it turns", async () => {
  const paths = await pathsBeyond(await pathsBeyond(0));
  const readout = () => page.getByTestId("traced-paths").textContent();
  await until("the readout's number of paths", async () => Number.parseFloat(await readout()) > 0);
  await screenshot("1-traced-light");
  await changing(() => drag(60, 0));
  await pathsBeyond(paths);
  await unfoldSettings();
  await changing(() => page.getByTestId("technique-traced-light").selectOption({ label: "Off" }));
  assert.equal(await page.getByTestId("traced-paths").count(), 0);
  assert.deepEqual(await chosenQuality(), []);
  assert.match(await page.getByTestId("quality-choice-about").innerText(), /Custom/);
  await foldSettings();
  await changing(() => drag(-60, 0));
});

test("fast draws fewer samples without detail, and the arrow keys change the quality", async () => {
  await unfoldSettings();
  const balanced = await restingFrameAfter(() => chooseQuality("Balanced"));
  assert.deepEqual(await chosenQuality(), ["Balanced"]);
  const slices = () => page.getByTestId("technique-slices-number").inputValue();
  const fine = Number(await slices());
  await tool("fields");
  assert.equal(await page.getByTestId("field-cloud").getByText("Detail").count(), 1);
  await unfoldSettings();

  await page.getByTestId("quality-choice-balanced").focus();
  await changing(() => page.keyboard.press("ArrowLeft"));
  assert.deepEqual(await chosenQuality(), ["Fast"]);
  assert.equal(Number(await slices()), fine / 2);
  assert.equal(await page.getByTestId("technique-detail").isChecked(), false);
  await tool("fields");
  assert.equal(await page.getByTestId("field-cloud").count(), 1);
  assert.equal(await page.getByTestId("field-cloud").getByText("Detail").count(), 0);
  await unfoldSettings();
  const fast = await restingFrame();
  await screenshot("2-fast");
  assert.ok(difference(balanced, fast) > 0.1, "without detail the picture is the same");

  await changing(() => setNumber(page, "technique-slices", fine / 2 + 1));
  assert.deepEqual(await chosenQuality(), []);
  await changing(() => setNumber(page, "technique-slices", fine / 2));
  assert.deepEqual(await chosenQuality(), ["Fast"]);

  const transport = page.getByTestId("technique-transport");
  await changing(() => transport.selectOption({ label: "Consistent" }));
  assert.equal(await page.getByTestId("technique-traced-light").count(), 0);
  assert.equal(await page.getByTestId("not-shown").count(), 0, "nothing is asked for in vain");
  const paper = page.getByTestId("papers-choice");
  const darker = await restingFrameAfter(() => paper.selectOption({ label: "Uniform phase, low albedo" }));
  assert.deepEqual(await chosenQuality(), []);
  assert.match(await page.getByTestId("quality-choice-about").innerText(), /low albedo/);
  assert.equal(await page.getByTestId("technique-per-field-phase").isChecked(), false);
  assert.equal(await page.getByTestId("technique-traced-light").count(), 0);
  assert.ok(difference(fast, darker) > 1, "single scattering looks like diffusion");
  // The following tests compare pictures at rest. Fast has no path-traced correction that would change them.
  await changing(() => chooseQuality("Fast"));
  await foldSettings();
});

test("fields in their false colours", async () => {
  await unfoldSettings();
  const usual = await restingFrame();
  const coloured = await restingFrameAfter(() => page.getByTestId("technique-false-colors").check());
  assert.ok(difference(usual, coloured) > 1, "false colours look like true ones");
  await tool("fields");
  const swatches = await page.locator("[data-testid^=field-][data-testid$=-color]").count();
  assert.ok(swatches > 1, `there are ${swatches} colours to choose`);
  await screenshot("2-false-colours");
  await unfoldSettings();
  await changing(() => page.getByTestId("technique-false-colors").uncheck());
  assert.deepEqual(await chosenQuality(), ["Fast"]);
  await foldSettings();
});

test("the readout says what the picture costs, and on what", async () => {
  await page.getByTestId("readout-summary").click();
  const stages = await page.getByTestId("stages").innerText();
  assert.match(stages, /Tone map\s+[\d.e-]+ ms/);
  assert.match(stages, /Technique\s+Light volume/);
  assert.match(stages, /All stages\s+[\d.e-]+ ms/);
  assert.match(stages, /Bytes\s+[\d.]+ (kB|MB)/);
  assert.match(await page.getByTestId("renderer").innerText(), /\S{3,}/);
  await screenshot("2-readout");
  await page.getByTestId("readout-summary").click();
});

test("a drag turns the storm, and the way back brings the first picture again", async () => {
  const { data: first, picture: firstPicture } = await grabRestingFrameOf(page);
  await changing(() => drag(220, 0));
  const { data: turned, picture: turnedPicture } = await grabRestingFrameOf(page);
  await screenshot("3-turned");
  const turnDeg = (Number(turned.azimuth) - Number(first.azimuth) + 360) % 360;
  // The drag turns 180 degrees across the picture's height.
  assert.ok(Math.abs(turnDeg - (220 / VIEWPORT.height) * 180) < 1, `it turned by ${turnDeg} degrees`);
  const change = difference(firstPicture, turnedPicture);
  assert.ok(change > 1, `the picture hardly changed: ${change}`);
  const back = difference(firstPicture, await restingFrameAfter(() => drag(-220, 0)));
  assert.ok(back < change / 4, `the way back differs by ${back}, the turn by ${change}`);
});

// drag.bench.mjs measures how long a picture takes.
test("pictures do not pile up while the storm is turned for a while", async () => {
  const start = { x: VIEWPORT.width * 0.4, y: VIEWPORT.height * 0.5 };
  await page.mouse.move(start.x, start.y);
  const { revision } = await rested();
  await page.mouse.down();
  for (let i = 0; i < 400; i += 1) {
    await page.mouse.move(start.x + 150 * Math.sin(i / 10), start.y + 40 * Math.sin(i / 17));
  }
  await until("pictures that move", async () => Number((await canvasData()).revision) > Number(revision));
  const moving = await canvasData();
  await page.mouse.up();
  await until("the last movement's picture", async () => {
    const data = await canvasData();
    return data.agreed !== "" && Number(data.revision) >= Number(data.agreed);
  });
  const pictures = Number((await canvasData()).sequence) - Number(moving.sequence);
  console.log(`pictures between the last movement and its picture: ${pictures}`);
  // The limit has four terms. They are the frames in flight to a viewer, the frames that wait in the server, those that
  // wait in the page, and the scenes in flight to the server.
  assert.ok(pictures <= 8 + 2 + 3 + 4, `${pictures} pictures were on their way`);
  await changing(() => page.keyboard.press("Home"));
});

test("the time slider shows another time", async () => {
  const firstPicture = await restingFrame();
  const firstTime = await page.getByTestId("valid-time").innerText();
  await page.getByTestId("time").focus();
  await changing(() => page.keyboard.press("ArrowRight"));
  const { data: shown, picture: later } = await grabRestingFrameOf(page);
  await screenshot("4-later");
  assert.equal(shown.time, "1");
  assert.notEqual(await page.getByTestId("valid-time").innerText(), firstTime);
  const change = difference(firstPicture, later);
  assert.ok(change > 0.5, `another time looks the same: ${change}`);
});

test("a field switched off goes, and with the last one the storm", async () => {
  const whole = await restingFrameAfter(async () => {
    await tool("map");
    await page.getByTestId("home").click();
    await tool("look");
    // The exposure is fixed, because automatic exposure would adapt to the fields that are still shown.
    await setNumber(page, "exposure", 0);
  });
  await tool("fields");
  const switches = page.locator("[data-testid$=-visible]");
  const names = await switches.evaluateAll((boxes) => boxes.map((box) => box.dataset.testid));
  assert.ok(names.includes("field-snow-visible"), `the fields are ${names}`);
  const sizes = page.getByTestId("field-snow-size");
  assert.match(await sizes.innerText(), /^Radius by WSM6, mean [\d.]+ µm$/);
  await changing(() => page.getByTestId("particle-sizes").selectOption({ label: "The papers' constants" }));
  assert.match(await sizes.innerText(), /^Radius by the papers: [\d.]+ µm$/);
  await changing(() => page.getByTestId("particle-sizes").selectOption({ label: "As the model has them" }));

  const withoutSnow = await restingFrameAfter(() => page.getByTestId("field-snow-visible").uncheck());
  await screenshot("5-without-snow");
  const sky = await restingFrameAfter(async () => {
    for (const name of names) await page.getByTestId(name).uncheck();
  });
  await screenshot("6-sky-alone");

  const [wholeShare, lessShare] = [differingShare(whole, sky), differingShare(withoutSnow, sky)];
  console.log(`share of the picture that is storm: ${wholeShare}, without snow ${lessShare}`);
  assert.ok(wholeShare > 0.01, `the storm covers only ${wholeShare} of the picture`);
  assert.ok(lessShare < wholeShare, `without snow the storm covers ${lessShare}, before ${wholeShare}`);
  assert.ok(difference(whole, withoutSnow) > 0.1, "without snow the picture is the same");

  const withAll = await restingFrameAfter(async () => {
    for (const name of names) await page.getByTestId(name).check();
  });
  const again = difference(whole, withAll);
  assert.ok(again < 1, `with all fields again the picture differs by ${again}`);
});

test("the sun set by the dome darkens the storm as it sinks", async () => {
  const high = boxMean(await restingFrame(), [0.2, 0.2, 0.6, 0.6]);
  await tool("light");
  await page.getByTestId("sun-dome").focus();
  const lowSun = await restingFrameAfter(async () => {
    for (let i = 0; i < 7; i += 1) await page.keyboard.press("ArrowDown");
  });
  await screenshot("7-low-sun");
  const low = boxMean(lowSun, [0.2, 0.2, 0.6, 0.6]);
  assert.ok(low < high, `the low sun gives ${low}, the high sun ${high}`);
  await tool("look");
  const exposed = boxMean(await restingFrameAfter(() => exposeAutomatically(page)), [0.2, 0.2, 0.6, 0.6]);
  assert.ok(exposed > low, `an automatic exposure of the low sun gives ${exposed}, ${low} without`);
  await tool("light");
  await page.getByTestId("sun-dome").focus();
  await changing(async () => {
    for (let i = 0; i < 7; i += 1) await page.keyboard.press("ArrowUp");
  });
});

test("the reference refines the picture while it rests, and begins again when it turns", async () => {
  await unfoldSettings();
  await page.getByTestId("technique-choice").selectOption({ label: "Monte Carlo reference" });
  const refinement = () => page.getByTestId("refinement").evaluate((text) => ({ ...text.dataset }));
  // The server starts with small pictures, which gather samples quickly. Each larger picture starts again without
  // samples.
  const reached = (samples) =>
    page.waitForFunction((least) => {
      const text = document.querySelector("[data-testid=refinement]");
      return Number(text?.dataset.samplesPerPixel) >= least;
    }, samples);
  await reached(2);
  const { relativeError } = await refinement();
  assert.ok(Number(relativeError) > 0, `the standard error is ${relativeError}`);
  const traced = await canvasData();
  await screenshot("8-refining");
  await drag(60, 0);
  await until("the turned picture", async () => {
    const { revision, agreed } = await canvasData();
    return Number(revision) > Number(traced.revision) && revision === agreed;
  });
  await reached(2);
  assert.equal(await page.getByTestId("technique-slices").count(), 0, "it has no slices");
  assert.equal(await page.getByTestId("technique-per-field-phase").isChecked(), true);
  await changing(async () => {
    await chooseQuality("Fast");
    await drag(-60, 0);
  });
  assert.equal(await page.getByTestId("refinement").count(), 0);
  await foldSettings();
});

test("metaballs draw the storm, and the page says what they leave out", async () => {
  await unfoldSettings();
  const choice = page.getByTestId("technique-choice");
  const before = await restingFrame();
  assert.equal(await page.getByTestId("technique-count").count(), 0);
  const balls = await restingFrameAfter(() => choice.selectOption({ label: "Metaballs" }));
  assert.deepEqual(await chosenQuality(), []);
  assert.equal(await page.getByTestId("technique-per-field-phase").isChecked(), true);
  await screenshot("9-metaballs");
  const { deviation } = spread(balls);
  assert.ok(deviation > 8, `the picture is nearly uniform: deviation ${deviation}`);
  const change = difference(before, balls);
  assert.ok(change > 0.5 && change < 40, `they differ from the light volume by ${change}`);
  assert.match(await page.getByTestId("not-shown").innerText(), /finer than the metaballs/);
  await page.getByTestId("readout-summary").click();
  assert.match(await page.getByTestId("stages").innerText(), /Metaballs\s+\d+/);
  await page.getByTestId("readout-summary").click();
  const isotropic = await restingFrameAfter(() => page.getByTestId("technique-isotropic").click());
  assert.ok(difference(balls, isotropic) > 0.01);
  await changing(() => page.getByTestId("technique-isotropic").click());

  // A slider that makes the server fit balls again reports its value only on release.
  const slider = page.getByTestId("technique-count");
  await slider.scrollIntoViewIfNeeded();
  const { x, y, width, height } = await slider.boundingBox();
  const updatesBefore = sceneUpdates();
  const ballsBefore = await page.getByTestId("technique-count-number").inputValue();
  await page.mouse.move(x + 0.7 * width, y + height / 2);
  // Pausing during the drag also reports the value.
  const dragSlider = async () => {
    await page.mouse.down();
    await page.mouse.move(x + 0.5 * width, y + height / 2, { steps: 15 });
    assert.notEqual(await page.getByTestId("technique-count-number").inputValue(), ballsBefore);
    assert.equal(sceneUpdates() - updatesBefore, 0, "balls are not fitted at each step of a drag");
    await page.mouse.up();
  };
  await changing(() => atOneMoment(page, dragSlider));
  assert.equal(sceneUpdates() - updatesBefore, 1);
  const before2 = await restingFrameAfter(() => setNumber(page, "technique-count", ballsBefore));

  const lights = async () => {
    await tool("light");
    const section = page.getByTestId("lights-section");
    if (!(await section.evaluate(({ open }) => open))) await section.locator("summary").click();
  };
  await lights();
  const warm = await restingFrameAfter(() => page.getByTestId("add-light").click());
  const both = await restingFrameAfter(() => page.getByTestId("add-light").click());
  await screenshot("9-lights");
  assert.ok(difference(before2, warm) > 0.5, "a light more is seen");
  assert.ok(difference(warm, both) > 0.5, "and another one");
  await unfoldSettings();
  assert.doesNotMatch(await page.getByTestId("not-shown").innerText(), /lights/);
  await lights();
  assert.match(await page.getByTestId("lights-shown").innerText(), / Shown by the technique under Look/);
  await unfoldSettings();
  await changing(() => choice.selectOption({ label: "Light volume" }));
  assert.match(await page.getByTestId("not-shown").innerText(), /lights in addition to the sun/);
  await lights();
  assert.match(
    await page.getByTestId("lights-shown").innerText(),
    /Not shown by the technique under Look, but by: .*Metaballs.*Monte Carlo/,
  );
  await unfoldSettings();
  // The server has filled in the settings that metaballs do not have.
  await until("the light volume has its own defaults", async () =>
    (await chosenQuality()).includes("Balanced"),
  );
  assert.equal(await page.getByTestId("technique-detail").isChecked(), true);
  await lights();
  await changing(() => page.getByTestId("light-1-remove").click());
  await changing(() => page.getByTestId("light-1-remove").click());
  assert.equal(await page.getByTestId("light-1").count(), 0);
  await tool("look");
  const fast = await restingFrameAfter(() => chooseQuality("Fast"));
  assert.equal(await page.getByTestId("not-shown").count(), 0);
  const changeBack = difference(before, fast);
  assert.ok(changeBack < 1, `the light volume is back, but for ${changeBack} levels`);
  await foldSettings();
});

test("a cumulus as a surface, and the parts of its light", async () => {
  await unfoldSettings();
  assert.equal(await page.getByTestId("technique-component").count(), 0);
  await changing(() =>
    page.getByTestId("technique-choice").selectOption({ label: "Cumulus surface" }),
  );
  for (const name of ["technique-transport", "technique-slices", "technique-theta-f-deg", "technique-detail", "technique-false-colors"]) {
    assert.equal(await page.getByTestId(name).count(), 0, `a cumulus has no ${name}`);
  }
  assert.match(await page.getByTestId("not-shown").innerText(), /snow/);
  await changing(() => page.getByTestId("technique-source").selectOption({ label: "Cauliflower" }));
  const whole = await restingFrameAfter(() => setNumber(page, "exposure", 0)); // the same exposure for all parts
  await screenshot("10-cumulus");
  assert.ok(spread(whole).deviation > 8, "the picture is nearly uniform");
  assert.match(await page.getByTestId("not-shown").innerText(), /generated from a seed/);
  let last = whole;
  for (const label of ["Direct sunlight", "Inter-reflection", "Sky and ground", "Corona"]) {
    const part = await restingFrameAfter(() => page.getByTestId("technique-component").selectOption({ label }));
    await screenshot(`10-cumulus-${label.toLowerCase().replaceAll(" ", "-")}`);
    const change = difference(last, part);
    assert.ok(change > 0.3, `${label} looks like the part before it: ${change}`);
    assert.ok(
      boxMean(part, [0.3, 0.3, 0.6, 0.6]) < boxMean(whole, [0.3, 0.3, 0.6, 0.6]),
      `${label} alone is no brighter than the whole`,
    );
    last = part;
  }
  const all = await restingFrameAfter(() => page.getByTestId("technique-component").selectOption({ label: "All" }));
  assert.ok(difference(whole, all) < 1, "the whole is back");
  await changing(async () => {
    await exposeAutomatically(page);
    await chooseQuality("Fast");
  });
  await foldSettings();
});

test("an accuracy asked for is reached by a setting that the server picks, or the nearest is told", async () => {
  await tool("look");
  await page.getByTestId("accuracy-section").locator("summary").click();
  const report = () => page.getByTestId("accuracy-report").evaluate((text) => ({ ...text.dataset }));
  const ask = async (error) => {
    await changing(async () => {
      await page.getByTestId("max-error-number").fill(String(error));
      await page.getByTestId("max-error-number").press("Enter");
    });
    // For techniques with slices, the slices' part of the error is measured at rest.
    await page.waitForFunction(() => {
      const report = document.querySelector("[data-testid=accuracy-report]")?.dataset;
      return report?.discretisationError !== undefined || report?.hasSlices === "false";
    });
    await rested();
  };
  await changing(() => page.getByTestId("accuracy-goal").selectOption("maxError"));
  await ask(3);
  assert.deepEqual(await chosenQuality(), []);
  assert.ok(Number((await report()).estimatedError) <= 3);
  assert.ok(Number((await report()).expectedMilliseconds) > 0);
  assert.equal(await page.getByTestId("accuracy-unmet").count(), 0);
  await screenshot("10-accuracy");
  await ask(0.001);
  assert.match(await page.getByTestId("accuracy-unmet").innerText(), /[Nn]o setting reaches an error of 0.001 .*the best has/);
  await screenshot("11-accuracy-unmet");
  await changing(() => page.getByTestId("accuracy-goal").selectOption("none"));
  assert.deepEqual(await chosenQuality(), ["Fast"]);
  await page.getByTestId("accuracy-section").locator("summary").click();
});

test("a number that is typed while frames come is kept", async () => {
  await tool("light");
  const number = page.getByTestId("turbidity-number");
  const before = await number.inputValue();
  await page.getByTestId("rate").selectOption("8");
  await page.getByTestId("play").click();
  await number.fill("4");
  const first = Number((await canvasData()).sequence);
  await until("three frames", async () => Number((await canvasData()).sequence) > first + 2);
  assert.equal(await number.inputValue(), "4", "it is still there");
  await number.press("Enter");
  assert.equal(await number.inputValue(), "4", "and is taken");
  await page.getByTestId("play").click();
  await changing(async () => {
    await number.fill(before);
    await number.press("Enter");
  });
  await tool(undefined);
});

test("play goes through the times and waits for each", async () => {
  const { time: first } = await rested();
  await page.getByTestId("storm-canvas").evaluate((canvas) => {
    window.timesSeen = [canvas.dataset.time];
    const note = () => window.timesSeen.at(-1) !== canvas.dataset.time && window.timesSeen.push(canvas.dataset.time);
    new MutationObserver(note).observe(canvas, { attributeFilter: ["data-time"] });
  });
  const seen = () => page.evaluate(() => window.timesSeen);
  await page.getByTestId("rate").selectOption("8");
  await page.getByTestId("play").click();
  await until("all times", async () => (await seen()).length > 4);
  await page.getByTestId("play").click();
  const inOrder = [0, 1, 2, 3, 4].map((step) => String((Number(first) + step) % 4));
  assert.deepEqual((await seen()).slice(0, 5), inOrder);
  await rested();
});

test("a tool opens with its key and Escape closes it", async () => {
  await page.getByTestId("storm-canvas").focus();
  await page.keyboard.press("l");
  assert.equal(await page.getByTestId("tool-panel").getAttribute("data-tool"), "light");
  await page.keyboard.press("6");
  assert.equal(await page.getByTestId("tool-panel").getAttribute("data-tool"), "probe");
  await page.keyboard.press("Escape");
  assert.equal(await page.getByTestId("tool-panel").count(), 0);
  await screenshot("13-no-tool");
});

test("a cloud is made to order and shown, and a bad one is named", async () => {
  const before = await restingFrame();
  await openPanel(page, "storms");
  await page.getByTestId("cloud-section").locator("summary").click();
  await page.getByTestId("cloud-own-shape").check();
  await page.getByTestId("cloud-ellipsoids").fill("0,0,1200,600,400");
  await page.getByTestId("make-cloud").click();
  await page.getByText("Line 1 of the ellipsoids").waitFor();
  await page.getByTestId("cloud-ellipsoids").fill("");
  await page.getByTestId("cloud-own-shape").uncheck();
  await page.getByTestId("cloud-seed-number").fill("3");
  await page.getByTestId("cloud-seed-number").press("Enter");
  await changing(() => page.getByTestId("make-cloud").click());
  assert.equal(await page.getByTestId("storm").inputValue(), "fair-weather-cumulus-3");
  const cloud = await restingFrame();
  await screenshot("cloud");
  assert.ok(difference(before, cloud) > 5, "the picture is of something else");
  assert.equal(await page.getByText("No cloud:").count(), 0);
  await changing(() => page.getByTestId("storm").selectOption("supercell"));
  assert.equal(await page.getByTestId("delete-cloud").count(), 0, "a storm of a file stays");
  await page.keyboard.press("Escape");
});

// Returns the number of pixels of the marks' own colour in the middle of the window.
async function inkInTheMiddle() {
  const color = await page.getByTestId("mark").evaluate((mark) => getComputedStyle(mark).color);
  const [red, green, blue] = color.match(/\d+/g).map(Number);
  const { width, height } = page.viewportSize();
  const clip = { x: width / 2 - 60, y: height / 2 - 60, width: 120, height: 120 };
  const { data } = PNG.sync.read(await page.screenshot({ clip }));
  let count = 0;
  for (let at = 0; at < data.length; at += 4)
    if (data[at] === red && data[at + 1] === green && data[at + 2] === blue) count += 1;
  return count;
}

// Checks where marks are shown in a comparison. Left of the edge is the storm with the marks, and right of it a storm
// of another domain, which must show no marks.
async function comparesMarks() {
  assert.ok((await inkInTheMiddle()) > 20, "the mark is not in the middle of the window");
  await openPanel(page, "compare");
  await page.getByTestId("compare-storm").selectOption("fair-weather-cumulus-3");
  await page.keyboard.press("Escape");
  const edge = page.getByTestId("swipe");
  await edge.fill("20");
  await until("a picture B without A's marks", async () => (await inkInTheMiddle()) === 0);
  await edge.fill("80");
  await until("a picture A with its marks", async () => (await inkInTheMiddle()) > 20);
  await openPanel(page, "compare");
  await page.getByTestId("compare-storm").selectOption("");
  await page.keyboard.press("Escape");
  await edge.fill("20");
  await until("marks on another picture of the same storm", async () => (await inkInTheMiddle()) > 20);
  await openPanel(page, "compare");
  await page.getByTestId("compare-end").click();
  await page.keyboard.press("Escape");
}

test("marks are gone while a storm of another domain is shown, and back with their own", async () => {
  const marksAre = (count) => until(`${count} marks`, async () => (await page.getByTestId("mark").count()) === count);
  const show = async (storm) => {
    await openPanel(page, "storms");
    await changing(() => page.getByTestId("storm").selectOption(storm));
    await page.keyboard.press("Escape");
  };
  const drawTo = async (count) => {
    await page.getByTestId("tool-pen").click();
    await page.getByTestId("mark-middle").click();
    await marksAre(count);
    await page.getByTestId("tool-pen").click();
  };
  await openTool(page, "marks");
  await drawTo(1);
  await show("fair-weather-cumulus-3");
  await marksAre(0);
  await drawTo(1);
  await drawTo(2);
  await show("supercell");
  await marksAre(1);
  await comparesMarks();
  await page.getByTestId("clear-marks").click();
  await marksAre(0);
  await show("fair-weather-cumulus-3");
  await marksAre(2);
  await page.getByTestId("clear-marks").click();
  await marksAre(0);
  await show("supercell");
  await openTool(page, undefined);
  await rested();
});

test("a cloud that was made can be deleted, after a second thought", async () => {
  await openPanel(page, "storms");
  await changing(() => page.getByTestId("storm").selectOption("fair-weather-cumulus-3"));
  const button = page.getByTestId("delete-cloud");
  await button.click();
  assert.match(await button.innerText(), /for all/);
  await changing(() => button.click());
  assert.equal(await page.getByTestId("storm").inputValue(), "supercell");
  await page.waitForFunction(
    () => document.querySelectorAll("[data-testid=storm] option").length === 1,
  );
  assert.equal(await button.count(), 0);
  await page.keyboard.press("Escape");
  await rested();
});

test("no error reached the browser's console", () => {
  assert.deepEqual(complaints, []);
});

test("a server that dies and comes back is found again with the same scene", async () => {
  const { data: before, picture: beforePicture } = await grabRestingFrameOf(page);
  await server.stop("SIGKILL");
  await page.getByTestId("connection-lost").waitFor({ state: "visible" });
  await screenshot("14-connection-lost");
  server = await startServer(ports);
  await page.getByTestId("connection-lost").waitFor({ state: "hidden" });
  const { data: healed, picture: healedPicture } = await grabRestingFrameOf(page);
  await screenshot("15-healed");
  assert.equal(healed.azimuth, before.azimuth);
  const change = difference(beforePicture, healedPicture);
  assert.ok(change < 1, `after healing the picture differs by ${change}`);
  const revision = healed.revision;
  const turned = await changing(() => drag(-100, 0));
  assert.notEqual(turned.revision, revision);
});

test("it works on a phone's screen", async () => {
  const phone = await browser.newPage({
    viewport: { width: 390, height: 780 },
    deviceScaleFactor: 1.5,
    hasTouch: true,
    isMobile: true,
  });
  try {
    await phone.goto(server.url);
    await rested(phone);
    assert.equal(await phone.getByTestId("tool-panel").count(), 0);
    await screenshot("16-phone", phone);
    await phone.getByTestId("rail-look").tap();
    assert.equal(await phone.getByTestId("tool-panel").isVisible(), true);
    await screenshot("17-phone-look", phone);
    const overflow = await phone.evaluate(
      () => document.documentElement.scrollWidth - document.documentElement.clientWidth,
    );
    assert.ok(overflow <= 0, `the page is ${overflow} pixels wider than the screen`);
    await restedAndFits(phone);
    const picture = await grabCanvas(phone);
    assert.equal(picture.width, 1.5 * 390);
    assert.ok(spread(picture).deviation > 8, "the phone's canvas is nearly uniform");

    await phone.getByTestId("rail-look").tap();
    const before = await canvasData(phone);
    const fingers = await phone.context().newCDPSession(phone);
    await changing(() => slide(fingers, [[200, 300]], [[120, 300]]), phone);
    const turned = await canvasData(phone);
    const turnDeg = (Number(turned.azimuth) - Number(before.azimuth) + 360) % 360;
    assert.ok(Math.abs(turnDeg - (360 - (80 / 780) * 180)) < 1, `a finger turned it by ${turnDeg}`);
    await changing(() => slide(fingers, [[150, 300], [250, 300]], [[100, 300], [300, 300]]), phone);
    const nearer = await canvasData(phone);
    const ratio = Number(nearer.distance) / Number(turned.distance);
    assert.ok(Math.abs(ratio - 0.5) < 0.02, `a pinch to twice the width changed the distance by ${ratio}`);
    await screenshot("18-phone-pinched", phone);
  } finally {
    await phone.close();
  }
});
