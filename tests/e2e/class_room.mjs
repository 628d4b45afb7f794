// A class: a server, a browser, a teacher and students with pages of their own, and what they do.
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { canvasData, changing, chooseQuality, dragBetween, launchBrowser, listenForErrors, openTool, rested, screenshot, until } from "./driver.mjs";
import { freePort, startServer } from "./server_process.mjs";

export const VIEWPORT = { width: 900, height: 560 };
export const MIDDLE = { x: 620, y: 300 };

export class ClassRoom {
  // Of the pages' consoles.
  complaints = [];

  // Opens the teacher's session.
  async open() {
    this.state = mkdtempSync(join(tmpdir(), "thunderhead-class-"));
    this.flags = { httpPort: await freePort(), grpcPort: await freePort(), state: this.state };
    await this.start();
    this.browser = await launchBrowser();
    this.teacher = await this.visit(this.server.url);
    await rested(this.teacher);
    // Without detail and traced light, so that pictures rest and are drawn soon.
    await changing(() => chooseQuality(this.teacher, "Fast"), this.teacher);
    return this.teacher;
  }

  async start() {
    this.server = await startServer(this.flags);
  }

  async close() {
    await this.browser?.close();
    await this.server?.stop();
    rmSync(this.state, { recursive: true, force: true });
  }

  // Each person has a browser profile, and so keys, of their own.
  async visit(address) {
    const context = await this.browser.newContext({
      viewport: VIEWPORT,
      permissions: ["clipboard-read", "clipboard-write"],
    });
    const page = await context.newPage();
    listenForErrors(page, this.complaints);
    await page.goto(address);
    await openTool(page, "look");
    return page;
  }

  async viewersLink() {
    await this.teacher.getByTestId("share").click();
    const link = await this.teacher.getByTestId("viewers-link").inputValue();
    await this.teacher.keyboard.press("Escape");
    return link;
  }

  // Waits until the teacher sees someone of that name; `shot` is a picture of the list.
  async teacherSees(name, shot) {
    await this.teacher.getByTestId("people").click();
    await this.teacher.getByTestId("people-list").getByText(name).waitFor();
    if (shot) await screenshot(shot, this.teacher);
    await this.teacher.keyboard.press("Escape");
  }

  // The teacher's and another's page show the same revision, refined.
  async inStep(student) {
    await until("the same picture on both pages", async () => {
      const [host, guest] = await Promise.all([canvasData(this.teacher), canvasData(student)]);
      return host.refined === "true" && guest.refined === "true" && host.revision === guest.revision;
    });
  }
}

export async function setRule(presenter, name, on) {
  await presenter.getByTestId("share").click();
  // It shows the session's rule: a presence that was on its way may set it back for a moment.
  const rule = presenter.getByTestId(`rule-${name}`);
  if ((await rule.isChecked()) !== on) await rule.click();
  await until(`the rule ${name}`, async () => (await rule.isChecked()) === on);
  await presenter.keyboard.press("Escape");
}

export async function nameThemselves(page, name) {
  await page.getByTestId("people").click();
  await page.getByTestId("own-name").fill(name);
  await page.getByTestId("own-name").press("Enter");
  await page.keyboard.press("Escape");
}

export const said = (page) => page.getByTestId("who-steers").innerText();

export const steers = async (page) => (await page.getByTestId("give-back").count()) === 1;

export const noticesOf = (page) => page.getByTestId("notices").innerText();

// Whose turn to steer it is, in the words of each page's button.
export const controlLabel = (page) => page.getByTestId("ask-control").innerText();

// A line of three corners, with the pen in the hand.
export async function drawLine(page, { x, y }) {
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 40, y + 10, { steps: 4 });
  await page.mouse.move(x + 80, y, { steps: 4 });
  await page.mouse.up();
}

export const turn = (page, rightPx) => dragBetween(page, MIDDLE, { x: MIDDLE.x + rightPx, y: MIDDLE.y });

export const exposure = (page) => page.getByTestId("exposure-number");

export const azimuthOf = async (page) => Number((await canvasData(page)).azimuth);

// The corners of the only mark on a page's overlay.
export function markOn(page) {
  return page
    .getByTestId("mark")
    .first()
    .evaluate(({ dataset }) => dataset.corners.split(" ").map((corner) => corner.split(",").map(Number)));
}

export const marksOn = (page) => page.getByTestId("mark").count();
