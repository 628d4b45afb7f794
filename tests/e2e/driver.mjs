// Drives the page in Chromium: starts it, waits for pictures, uses its controls.
import { mkdirSync } from "node:fs";
import { setTimeout } from "node:timers/promises";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { grabCanvas } from "./pictures.mjs";

const OUTPUT = fileURLToPath(new URL("output/", import.meta.url));
const CHROMIUM = process.env.THUNDERHEAD_CHROMIUM ?? "/usr/bin/chromium";
const CHROMIUM_ARGS = [
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];
// A wait that takes longer counts as hung. No test depends on how fast the machine is.
export const HANG_MS = 600_000;
export const PICTURE_TIMEOUT_MS = HANG_MS;
const POLL_MS = 50;

// The ratio is small, because the server and the browser draw in software, which is slow. It does not change the page's
// layout. A test of the picture's size sets its own ratio.
const PIXELS_PER_CSS_PIXEL = 0.5;

// Starts a browser. Every wait of its pages ends after HANG_MS.
export async function launchBrowser(more = []) {
  mkdirSync(OUTPUT, { recursive: true });
  const options = { executablePath: CHROMIUM, args: [...CHROMIUM_ARGS, ...more], timeout: HANG_MS };
  const browser = await chromium.launch(options);
  const newContext = browser.newContext.bind(browser);
  browser.newContext = async (options) => {
    const context = await newContext({ deviceScaleFactor: PIXELS_PER_CSS_PIXEL, ...options });
    context.setDefaultTimeout(HANG_MS);
    return context;
  };
  return browser;
}

// Adds errors of a page's scripts and console to the list.
export function listenForErrors(page, complaints) {
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error") complaints.push(message.text());
  });
}

export const screenshot = (name, page) => page.screenshot({ path: `${OUTPUT}${name}.png` });

// Returns the data that the page reports about a picture on a canvas, and the canvas's size. `boxSize` is the size that
// the page's layout gives the canvas.
const dataOf = (canvas) => {
  const box = [canvas.clientWidth, canvas.clientHeight].map((length) => Math.max(1, Math.round(length * devicePixelRatio)));
  return { ...canvas.dataset, canvasSize: `${canvas.width}x${canvas.height}`, boxSize: box.join("x") };
};

export function canvasData(page, testId = "storm-canvas") {
  return page.getByTestId(testId).evaluate(dataOf);
}

// Waits until `holds` returns true.
export async function until(what, holds, timeoutMs = HANG_MS) {
  const deadline = Date.now() + timeoutMs;
  while (!(await holds())) {
    if (Date.now() >= deadline) throw new Error(`never came: ${what}`);
    await setTimeout(POLL_MS);
  }
}

const fits = ({ size, canvasSize, boxSize }) => size === canvasSize && canvasSize === boxSize;

// Returns whether the picture is the refined one of a scene at rest. The page reports the revision that it and the
// server agree on, including every change made on this page. An own view's revisions are counted separately.
const isRefined = ({ refined, ownView, agreed, revision }) =>
  refined === "true" && (ownView === "true" || (Boolean(agreed) && Number(revision) >= Number(agreed)));

const isWhole = (data) => isRefined(data) && fits(data);

// Returns whether the picture is a resting frame (AVIF) at full quality. A busy machine first draws pictures with an
// image_scale below 1.
const isRestingFrame = (data) => isWhole(data) && data.encoding === "avif" && Number(data.scale) === 1;

async function reached(what, page, holds, testId) {
  let data;
  await until(what, async () => {
    data = await canvasData(page, testId);
    return holds(data);
  });
  return data;
}

// Waits for a refined picture of the newest scene, with every change that was made on this page.
export const rested = (page, testId) => reached("a refined picture", page, isRefined, testId);

// Waits like `rested`, for a picture that has the canvas's size. While panels open and close, the picture still has its
// previous size.
export const restedAndFits = (page, testId) => reached("a refined picture of the canvas's size", page, isWhole, testId);

// Waits like `restedAndFits`, until the picture at full quality is shown as a resting frame, an AVIF that replaces the
// JPEG. The pixels of the two differ by about one level of 255.
export const restingFrame = (page) => reached("a resting frame of the canvas's size and of full quality", page, isRestingFrame);

// Returns the resting frame's pixels and the data that the page reports about it. Both belong to the same frame.
export async function grabRestingFrame(page) {
  let data;
  let picture;
  await until("a resting frame that stays while it is read", async () => {
    data = await restingFrame(page);
    picture = await grabCanvas(page);
    const after = await canvasData(page);
    return isRestingFrame(after) && after.sequence === data.sequence;
  });
  return { data, picture };
}

// Runs an action that changes the scene, and waits for the refined picture of the new scene.
export async function changing(action, page) {
  // If there is no picture yet, any picture is newer.
  const revisionBefore = Number((await canvasData(page)).revision ?? -1);
  await action();
  await reached("a newer revision", page, ({ revision }) => Number(revision) > revisionBefore);
  return rested(page);
}

// Drags with the left button from one position to another.
export async function dragBetween(page, from, to, steps = 12) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, { steps });
  await page.mouse.up();
}

// Runs an action as if it took the page no time: timers set meanwhile start when it has ended.
export async function atOneMoment(page, action) {
  await page.evaluate(() => {
    const [start, clear] = [window.setTimeout, window.clearTimeout];
    const held = new Map();
    const started = new Map();
    let last = 0;
    window.setTimeout = (...timer) => {
      last -= 1;
      held.set(last, timer);
      return last;
    };
    window.clearTimeout = (id) => {
      if (!held.delete(id)) clear.call(window, started.get(id) ?? id);
    };
    window.endMoment = () => {
      window.setTimeout = start;
      for (const [id, timer] of held) started.set(id, start.call(window, ...timer));
      held.clear();
    };
  });
  try {
    return await action();
  } finally {
    await page.evaluate(() => window.endMoment());
  }
}

const PICTURES_OF_MOVIE = /FetchRenderResult|RenderImage/;

// Runs an action while no picture of a movie reaches the page, so that the movie cannot end.
export async function holdingMovie(page, action) {
  let release;
  const released = new Promise((resolve) => {
    release = resolve;
  });
  const hold = async (route) => {
    await released;
    // The page may have cancelled the call meanwhile.
    await route.continue().catch(() => undefined);
  };
  await page.route(PICTURES_OF_MOVIE, hold);
  try {
    return await action();
  } finally {
    release();
    await page.unroute(PICTURES_OF_MOVIE, hold);
  }
}

// Advances the clock that the page's scripts read.
export async function passTime(page, ms) {
  await page.evaluate((passed) => {
    const now = performance.now.bind(performance);
    performance.now = () => now() + passed;
  }, ms);
}

// Sets the number field of a slider, which may be in a folded section.
export async function setNumber(page, name, value) {
  await page.getByTestId(`${name}-number`).evaluate((input, text) => {
    input.value = text;
    input.dispatchEvent(new Event("change", { bubbles: true }));
  }, String(value));
}

// Presses the Tab key until the focus is on the element with this test id, or on the summary of the section with this
// test id.
export async function tabTo(page, testId, most = 80) {
  for (let presses = 0; presses <= most; presses += 1) {
    const focused = await page.evaluate(() => {
      const element = document.activeElement;
      return (element?.matches("summary") ? element.parentElement : element)?.dataset.testid;
    });
    if (focused === testId) return;
    await page.keyboard.press("Tab");
  }
  throw new Error(`the tabulator key does not reach ${testId}`);
}

// Answers a forecaster's question, and prints how long that takes. The time includes only what a person does and waits
// for, without a movie that the server continues to draw.
export async function timed(question, answer) {
  const began = Date.now();
  const given = await answer();
  console.log(`figure: ${question}: ${((Date.now() - began) / 1000).toFixed(1)} s`);
  return given;
}

// Opens a tool of the rail; undefined closes the open tool.
export async function openTool(page, name) {
  const open = page.locator("[data-testid=rail] button[aria-controls=tool][aria-expanded=true]");
  const now = (await open.count()) > 0 ? (await open.getAttribute("data-testid")).slice(5) : undefined;
  if (now === name) return;
  await page.getByTestId(`rail-${name ?? now}`).click();
}

// Chooses a quality in the open tool Look, once the page knows whether its settings match a quality.
export async function chooseQuality(page, word) {
  const about = page.getByTestId("quality-choice-about");
  await until("settings from the server", async () => !(await about.innerText()).startsWith("Waiting"));
  await page.getByTestId("quality-choice").getByText(word, { exact: true }).click();
}

const PANEL_BUTTONS = { help: "rail-help", drawer: "rail-settings" };
// Panels whose buttons a narrow window shows only in another panel. Each entry has that panel and the button in it.
const UNDER_OTHERS = {
  compare: ["storms", "storms-compare"],
  help: ["storms", "storms-help"],
  people: ["share", "share-people"],
};

// Opens a panel of the top bar.
export async function openPanel(page, name) {
  const button = page.getByTestId(PANEL_BUTTONS[name] ?? name);
  if (await button.isVisible()) return button.click();
  const [panel, inIt] = UNDER_OTHERS[name];
  await page.getByTestId(panel).click();
  await page.getByTestId(inIt).click();
}
