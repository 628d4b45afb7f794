// Drives the page in Chromium: starts it, waits for pictures, uses its controls.
import { mkdirSync } from "node:fs";
import { setTimeout } from "node:timers/promises";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

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
// Software rendering on two busy cores may take seconds for a refined picture.
export const PICTURE_TIMEOUT_MS = 120_000;
const REST_MS = 600;
// The first refined frame may be smaller than the last, which follows within this time.
const LARGER_WITHIN_MS = 4000;

export function launchBrowser(more = []) {
  mkdirSync(OUTPUT, { recursive: true });
  return chromium.launch({ executablePath: CHROMIUM, args: [...CHROMIUM_ARGS, ...more] });
}

// Errors of a page's scripts and console go into the list.
export function listenForErrors(page, complaints) {
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error") complaints.push(message.text());
  });
}

export const screenshot = (name, page) => page.screenshot({ path: `${OUTPUT}${name}.png` });

export function canvasData(page) {
  return page.getByTestId("storm-canvas").evaluate((canvas) => ({
    ...canvas.dataset,
    canvasSize: `${canvas.width}x${canvas.height}`,
  }));
}

// Waits until `holds` gives true.
export async function until(what, holds, timeoutMs = PICTURE_TIMEOUT_MS) {
  const deadline = Date.now() + timeoutMs;
  while (!(await holds())) {
    if (Date.now() >= deadline) throw new Error(`never came: ${what}`);
    await setTimeout(50);
  }
}

const fits = ({ size, canvasSize }) => size === canvasSize;

// Waits until `holds` has held without a break: for REST_MS for one frame on the canvas, or for LARGER_WITHIN_MS for
// frames of one size that are smaller than the canvas.
async function resting(what, page, holds) {
  let held = { name: undefined, since: 0 };
  await until(what, async () => {
    const data = await canvasData(page);
    const now = Date.now();
    const good = holds(data);
    const name = fits(data) ? data.sequence : data.size;
    if (!good || name !== held.name) held = { name, since: now };
    return good && now - held.since >= (fits(data) ? REST_MS : LARGER_WITHIN_MS);
  });
  return canvasData(page);
}

export const rested = (page) => resting("a refined picture that rests", page, ({ refined }) => refined === "true");

// Like `rested`, of a picture that has the canvas's size: while panels open and close the picture still has the size before.
export function restedAndFits(page) {
  const whole = (data) => data.refined === "true" && fits(data);
  return resting("a refined picture of the canvas's size that rests", page, whole);
}

// Like `restedAndFits`, once the still has come that replaces the frame's JPEG, from which it differs by about a level,
// and of a picture at full quality: a machine that is busy draws a coarser one before.
export function restedStill(page) {
  const still = (data) =>
    data.refined === "true" && data.encoding === "avif" && fits(data) && Number(data.scale) === 1;
  return resting("a still of the canvas's size and of full quality that rests", page, still);
}

// Runs an action that changes the scene, and waits for the refined picture of the new scene.
export async function changing(action, page) {
  const revisionBefore = Number((await canvasData(page)).revision);
  await action();
  await page.waitForFunction(
    (revision) => {
      const canvas = document.querySelector("[data-testid=storm-canvas]");
      return Number(canvas?.dataset.revision) > revision;
    },
    revisionBefore,
    { timeout: PICTURE_TIMEOUT_MS },
  );
  return rested(page);
}

// With the left button, from one place to another.
export async function dragBetween(page, from, to, steps = 12) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, { steps });
  await page.mouse.up();
}

// Sets the number field of a slider, which may be folded away.
export async function setNumber(page, name, value) {
  await page.getByTestId(`${name}-number`).evaluate((input, text) => {
    input.value = text;
    input.dispatchEvent(new Event("change", { bubbles: true }));
  }, String(value));
}

// Moves the focus with the tabulator key until it is on an element of that name, or on the summary of a section of that name.
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

// A forecaster has a minute for each question. Only what a person does and waits for is within it: not a movie that the
// server goes on drawing, nor an error that is measured better with every second.
const MOST_MS_A_QUESTION = 60_000;

export async function withinAMinute(question, answer) {
  const began = Date.now();
  const given = await answer();
  const tookMs = Date.now() - began;
  console.log(`${question}: ${(tookMs / 1000).toFixed(1)} s`);
  if (tookMs > MOST_MS_A_QUESTION) throw new Error(`${question}: took ${tookMs} ms`);
  return given;
}

// Opens a tool of the rail; undefined closes the one that is open.
export async function openTool(page, name) {
  const open = page.locator("[data-testid=rail] button[aria-controls=tool][aria-expanded=true]");
  const now = (await open.count()) > 0 ? (await open.getAttribute("data-testid")).slice(5) : undefined;
  if (now === name) return;
  await page.getByTestId(`rail-${name ?? now}`).click();
}

// In the tool of looks, which is open, once the page has learned the settings it has: those of a quality, or of none.
export async function chooseQuality(page, word) {
  const about = page.getByTestId("quality-choice-about");
  await until("settings from the server", async () => !(await about.innerText()).startsWith("Waiting"));
  await page.getByTestId("quality-choice").getByText(word, { exact: true }).click();
}

const PANEL_BUTTONS = { help: "rail-help", drawer: "rail-settings" };
// In a narrow window they are under others: the panel, and the button in it.
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
