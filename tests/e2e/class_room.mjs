// A class: a server, a browser, a teacher and students, each with a page, and their actions.
import { mkdtempSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { canvasData, changing, chooseQuality, dragBetween, launchBrowser, listenForErrors, openTool, screenshot, until } from "./driver.mjs";
import { freePort, startServer } from "./server_process.mjs";

export const VIEWPORT = { width: 900, height: 560 };
export const MIDDLE = { x: 620, y: 300 };

// Timeouts of the server in seconds. A wait of one viewer for another never expires, however slow the machine is, and a
// viewer may ask for control again at once.
export const NEVER = 1e6;
const WAITS = { answer: NEVER, ask_again: 0, away: NEVER, come_back: NEVER, come_back_to_new_server: NEVER };

// Factor by which the page's notices stay visible longer.
const NOTES_STAY = 20;

export class ClassRoom {
  // Errors that the pages wrote to their consoles.
  complaints = [];

  // Starts the server and opens the teacher's session. For `prepare` see visit().
  async open(prepare) {
    this.folder = mkdtempSync(join(tmpdir(), "thunderhead-class-"));
    const timeouts = this.#writeTimeouts(WAITS);
    this.flags = {
      httpPort: await freePort(),
      grpcPort: await freePort(),
      state: join(this.folder, "state"),
      more: ["--roster-timeouts", timeouts],
    };
    await this.start();
    this.browser = await launchBrowser();
    this.teacher = await this.visit(this.server.url, prepare);
    // Detail and the path-traced correction are off, so that pictures are drawn and rest quickly.
    await changing(() => chooseQuality(this.teacher, "Fast"), this.teacher);
    return this.teacher;
  }

  async start() {
    this.server = await startServer(this.flags);
    await this.#untilTimeoutsTaken(1);
  }

  async close() {
    await this.browser?.close();
    await this.server?.stop();
    rmSync(this.folder, { recursive: true, force: true });
  }

  // Runs `meanwhile` while the server uses other timeouts, given in seconds (RosterTimeouts in the server).
  async whileWaiting(seconds, meanwhile) {
    await this.#setTimeouts({ ...WAITS, ...seconds });
    await meanwhile();
    await this.#setTimeouts(WAITS);
  }

  async #setTimeouts(seconds) {
    const times = this.#timesTaken();
    this.#writeTimeouts(seconds);
    await this.#untilTimeoutsTaken(times + 1);
  }

  // The file is moved into place, so that the server never reads half a file.
  #writeTimeouts(seconds) {
    const file = join(this.folder, "timeouts");
    const lines = Object.entries(seconds).map(([name, value]) => `${name} ${value}\n`);
    writeFileSync(`${file}.new`, lines.join(""));
    renameSync(`${file}.new`, file);
    return file;
  }

  #timesTaken() {
    return Number(this.server.log().match(/(?<=roster timeouts taken )\d+(?= times)/g)?.at(-1) ?? 0);
  }

  #untilTimeoutsTaken(times) {
    return until("the server has taken the timeouts", () => this.#timesTaken() >= times);
  }

  // Waits until the server has stored the sessions as they are now. It answers calls that open or close a session only
  // after that.
  async stored() {
    const call = (method, body) =>
      fetch(`${this.server.url}thunderhead.v1.ThunderheadService/${method}`, {
        method: "POST",
        headers: { "content-type": "application/grpc-web+proto" },
        body: Buffer.concat([Buffer.from([0, 0, 0, 0, body.length]), body]),
      });
    const answer = Buffer.from(await (await call("CreateSession", Buffer.alloc(0))).arrayBuffer());
    // The first field of the response is the session's key.
    const key = answer.subarray(7, 7 + answer[6]);
    if (answer[0] !== 0 || answer[5] !== 10) throw new Error(`no session was created: ${answer}`);
    await (await call("CloseSession", Buffer.concat([Buffer.from([10, key.length]), key]))).arrayBuffer();
  }

  // Opens a page with its own browser profile, and therefore its own keys. `prepare` is called with the page before it
  // is opened.
  async visit(address, prepare = () => undefined) {
    const context = await this.browser.newContext({
      viewport: VIEWPORT,
      permissions: ["clipboard-read", "clipboard-write"],
    });
    await context.addInitScript(letNotesStay, NOTES_STAY);
    const page = await context.newPage();
    await prepare(page);
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

  // Lets the teacher set a rule, and waits until the student's page knows it.
  async setRuleFor(student, name, on) {
    await setRule(this.teacher, name, on);
    // The server sends all rules together. The student's page therefore knows this rule once it knows a rule that is
    // set later.
    const asks = student.getByTestId("ask-control");
    await setRule(this.teacher, "controlLocked", true);
    await until("a locked button", () => asks.isDisabled());
    await setRule(this.teacher, "controlLocked", false);
    await until("an unlocked button", () => asks.isEnabled());
  }

  // Waits until the teacher sees a viewer of that name; `shot` names a screenshot of the list.
  async teacherSees(name, shot) {
    await this.teacher.getByTestId("people").click();
    await this.teacher.getByTestId("people-list").getByText(name).waitFor();
    if (shot) await screenshot(shot, this.teacher);
    await this.teacher.keyboard.press("Escape");
  }

  // Waits until the teacher's and the student's page show the same revision, refined.
  async inStep(student) {
    await until("the same picture on both pages", async () => {
      const [host, guest] = await Promise.all([canvasData(this.teacher), canvasData(student)]);
      return host.refined === "true" && guest.refined === "true" && host.revision === guest.revision;
    });
  }
}

// Runs in the page. Makes notes stay longer, so that a slow test sees them, and lets the pointer through to the picture
// that they cover.
function letNotesStay(times) {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync("[data-testid=notices] * { pointer-events: none !important }");
  document.adoptedStyleSheets = [sheet];
  const NOTE_MS = 6000;
  const start = window.setTimeout;
  window.setTimeout = (callback, delayMs, ...more) =>
    start.call(window, callback, delayMs === NOTE_MS ? times * delayMs : delayMs, ...more);
}

export async function setRule(presenter, name, on) {
  await presenter.getByTestId("share").click();
  // The checkbox shows the session's rule. A presence message that is still in flight may reset the checkbox for a
  // moment.
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

// Returns the label of the page's control button, which tells who has control.
export const controlLabel = (page) => page.getByTestId("ask-control").innerText();

// Draws a line of three corners with the pen.
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

// Returns the corners of the only mark on a page's overlay.
export function markOn(page) {
  return page
    .getByTestId("mark")
    .first()
    .evaluate(({ dataset }) => dataset.corners.split(" ").map((corner) => corner.split(",").map(Number)));
}

export const marksOn = (page) => page.getByTestId("mark").count();
