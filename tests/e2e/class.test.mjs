// End-to-end test of a shared session: a teacher and students with pages of their own before the real server.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  canvasData,
  changing,
  dragBetween,
  launchBrowser,
  listenForErrors,
  openTool,
  rested,
  screenshot,
  setNumber,
  until,
} from "./driver.mjs";
import { difference, grabCanvas } from "./pictures.mjs";
import { freePort, startServer } from "./server_process.mjs";

const VIEWPORT = { width: 900, height: 560 };
const MIDDLE = { x: 620, y: 300 };
// Half a pixel on either side, and the rounding of the overlay's numbers.
const SAME_PLACE_PX = 2;
// The server takes one request for control in five seconds from a person.
const ASK_AGAIN_AFTER_MS = 5100;

let server;
let browser;
let teacher;
let student;
const complaints = [];

// Each person has a browser profile, and so keys, of their own.
async function visit(address) {
  const context = await browser.newContext({
    viewport: VIEWPORT,
    permissions: ["clipboard-read", "clipboard-write"],
  });
  const page = await context.newPage();
  listenForErrors(page, complaints);
  await page.goto(address);
  await openTool(page, "look");
  return page;
}

async function viewersLink() {
  await teacher.getByTestId("share").click();
  const link = await teacher.getByTestId("viewers-link").inputValue();
  await teacher.keyboard.press("Escape");
  return link;
}

async function setRule(name, on) {
  await teacher.getByTestId("share").click();
  await teacher.getByTestId(`rule-${name}`).setChecked(on);
  await teacher.keyboard.press("Escape");
}

const turn = (page, rightPx) => dragBetween(page, MIDDLE, { x: MIDDLE.x + rightPx, y: MIDDLE.y });

const exposure = (page) => page.getByTestId("exposure-number");

const azimuthOf = async (page) => Number((await canvasData(page)).azimuth);

// Both pages show the same revision, refined.
async function inStep() {
  await until("the same picture on both pages", async () => {
    const [host, guest] = await Promise.all([canvasData(teacher), canvasData(student)]);
    return host.refined === "true" && guest.refined === "true" && host.revision === guest.revision;
  });
}

// The corners of the only mark on a page's overlay.
function markOn(page) {
  return page
    .getByTestId("mark")
    .first()
    .evaluate(({ dataset }) => dataset.corners.split(" ").map((corner) => corner.split(",").map(Number)));
}

const marksOn = (page) => page.getByTestId("mark").count();

function middleOf(points) {
  const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
  return [xs, ys].map((values) => (Math.min(...values) + Math.max(...values)) / 2);
}

before(async () => {
  server = await startServer({ httpPort: await freePort(), grpcPort: await freePort() });
  browser = await launchBrowser();
  teacher = await visit(server.url);
  await rested(teacher);
  // Without detail and traced light, so that pictures rest and are drawn soon.
  await changing(
    () => teacher.getByTestId("quality-choice").getByText("Fast", { exact: true }).click(),
    teacher,
  );
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

test("the teacher shares a link and a code, and keeps the presenter's key", async () => {
  await teacher.getByTestId("share").click();
  await screenshot("20-share", teacher);
  const link = await teacher.getByTestId("viewers-link").inputValue();
  assert.match(link, /\?session=[^&#]+$/);
  const modules = await teacher.locator("[data-testid=qr] path").getAttribute("d");
  assert.ok(modules.length > 1000, "the code is empty");
  await teacher.getByTestId("copy-link").click();
  const copied = await teacher.evaluate(() => navigator.clipboard.readText());
  assert.ok(copied.startsWith(`${link}#scene=`), copied);
  await teacher.keyboard.press("Escape");
  assert.equal(await teacher.getByTestId("share-panel").count(), 0);
  assert.ok(teacher.url().startsWith(link), `${teacher.url()} is not ${link}`);
  const kept = await teacher.evaluate(() => localStorage.getItem("thunderhead.presenter-keys"));
  const [viewerKey, presenterKey] = JSON.parse(kept).at(-1);
  assert.ok(link.endsWith(viewerKey));
  assert.ok(!teacher.url().includes(presenterKey), "the presenter's key is in the address");
});

test("a student joins by the link and sees the same picture, but cannot change it", async () => {
  student = await visit(await viewersLink());
  await inStep();
  const apart = difference(await grabCanvas(teacher), await grabCanvas(student));
  assert.ok(apart < 1, `the pictures differ by ${apart}`);
  await changing(() => setNumber(teacher, "exposure", 0.7), teacher);
  await inStep();
  assert.equal(await exposure(student).inputValue(), "0.7");
  assert.equal(await exposure(student).isDisabled(), true);
  assert.equal(await student.getByTestId("exposure").isDisabled(), true);
  assert.match(await student.getByTestId("edit-block").innerText(), /steers/);
  assert.equal(await exposure(teacher).isDisabled(), false);
  const { revision } = await canvasData(teacher);
  await student.keyboard.press(".");
  await openTool(student, "light");
  await student.getByTestId("sun-dome").press("ArrowDown");
  await student.waitForTimeout(500);
  assert.equal((await canvasData(teacher)).revision, revision);
  await openTool(student, "look");
  await screenshot("21-student", student);
});

test("a student looks around alone, and comes back", async () => {
  const before = await azimuthOf(teacher);
  await turn(student, 140);
  await student.getByTestId("looking-around").waitFor();
  await until("the student's own view", async () => {
    const { ownView, azimuth } = await canvasData(student);
    const turnedDeg = (Number(azimuth) - before + 360) % 360;
    return ownView === "true" && Math.abs(turnedDeg - (140 / VIEWPORT.height) * 180) < 1;
  });
  await screenshot("22-looking-around", student);
  assert.equal(await azimuthOf(teacher), before);
  const apart = difference(await grabCanvas(teacher), await grabCanvas(student));
  assert.ok(apart > 1, `the own view differs by ${apart} alone`);
  // The same storm, time and light: what the teacher changes is seen in the own view.
  const own = await grabCanvas(student);
  await changing(() => setNumber(teacher, "exposure", -1.5), teacher);
  await until("the own view darker", async () => difference(own, await grabCanvas(student)) > 3);
  assert.equal((await canvasData(student)).ownView, "true");
  await student.getByTestId("follow").click();
  await until("the teacher's view", async () => (await canvasData(student)).ownView === "false");
  await inStep();
  assert.equal(await azimuthOf(student), before);
  assert.equal(await student.getByTestId("looking-around").count(), 0);
});

test("a student asks to steer, is given control, and gives it back", async () => {
  await student.getByTestId("ask-control").click();
  await teacher.getByTestId("asks").waitFor();
  assert.equal((await teacher.getByTestId("asking-badge").innerText()).trim()[0], "1");
  await screenshot("23-asked", teacher);
  await teacher.getByTestId("asks-give").click();
  await student.getByTestId("give-back").waitFor();
  assert.equal(await exposure(student).isDisabled(), false);
  await teacher.getByTestId("edit-block").waitFor();
  assert.equal(await exposure(teacher).isDisabled(), true);
  await changing(() => setNumber(student, "exposure", 0.4), student);
  await inStep();
  assert.equal(await exposure(teacher).inputValue(), "0.4");
  const before = await azimuthOf(teacher);
  await changing(() => turn(student, 60), student);
  await inStep();
  assert.notEqual(await azimuthOf(teacher), before);
  await student.getByTestId("give-back").click();
  await student.getByTestId("ask-control").waitFor();
  await teacher.getByTestId("edit-block").waitFor({ state: "detached" });
  assert.equal(await exposure(teacher).isDisabled(), false);
});

test("the teacher gives control unasked, and takes it back", async () => {
  await teacher.getByTestId("people").click();
  await teacher.getByTestId("give-unasked").click();
  await teacher.keyboard.press("Escape");
  await student.getByTestId("give-back").waitFor();
  await teacher.getByTestId("take-control").click();
  await student.getByTestId("give-back").waitFor({ state: "detached" });
  assert.equal(await exposure(student).isDisabled(), true);
  assert.equal(await exposure(teacher).isDisabled(), false);
});

test("the teacher says not now, and locks control", async () => {
  await student.waitForTimeout(ASK_AGAIN_AFTER_MS);
  await student.getByTestId("ask-control").click();
  await teacher.getByTestId("asks-give-not").click();
  await teacher.getByTestId("asks").waitFor({ state: "detached" });
  assert.equal(await student.getByTestId("give-back").count(), 0);
  await setRule("controlLocked", true);
  await until("a locked button", () => student.getByTestId("ask-control").isDisabled());
  await setRule("controlLocked", false);
  await until("an unlocked button", () => student.getByTestId("ask-control").isEnabled());
});

test("a line that the teacher draws is on the student's picture at the same place, and stays on the storm", async () => {
  await inStep();
  await openTool(teacher, "marks");
  await teacher.getByTestId("tool-pen").click();
  await teacher.mouse.move(MIDDLE.x + 60, MIDDLE.y);
  await teacher.mouse.down();
  for (let step = 1; step <= 40; step += 1) {
    const angle = (step / 40) * 2 * Math.PI;
    await teacher.mouse.move(MIDDLE.x + 60 * Math.cos(angle), MIDDLE.y + 40 * Math.sin(angle));
  }
  await teacher.mouse.up();
  await until("the mark on both pages", async () => {
    return (await marksOn(teacher)) === 1 && (await marksOn(student)) === 1;
  });
  const [drawn, seen] = [await markOn(teacher), await markOn(student)];
  assert.ok(drawn.length > 10 && drawn.length <= 64, `it has ${drawn.length} corners`);
  assert.equal(seen.length, drawn.length);
  for (const [at, [x, y]] of seen.entries()) {
    const away = Math.hypot(x - drawn[at][0], y - drawn[at][1]);
    assert.ok(away < SAME_PLACE_PX, `corner ${at} is ${away} pixels away`);
    const radius = Math.hypot((x - MIDDLE.x) / 60, (y - MIDDLE.y) / 40);
    assert.ok(Math.abs(radius - 1) < 0.1, `corner ${at} is not on the line drawn: ${radius}`);
  }
  await screenshot("24-mark", student);
  await teacher.keyboard.press("Escape");
  await changing(() => turn(teacher, 40), teacher);
  await inStep();
  const [turned, turnedSeen] = [middleOf(await markOn(teacher)), middleOf(await markOn(student))];
  const [before] = middleOf(drawn);
  assert.ok(Math.abs(turned[0] - before) > 3, "the mark does not turn with the storm");
  assert.ok(Math.hypot(turned[0] - turnedSeen[0], turned[1] - turnedSeen[1]) < SAME_PLACE_PX);
  await screenshot("25-mark-turned", student);
});

test("the teacher's pointer is seen where it points, and goes with the tool", async () => {
  await teacher.getByTestId("tool-pointer").click();
  await teacher.mouse.move(MIDDLE.x - 10, MIDDLE.y);
  await teacher.mouse.move(MIDDLE.x, MIDDLE.y);
  await until("the pointer at its place", async () => {
    const box = await student.locator("[data-testid=pointer] circle").last().boundingBox();
    if (box === null) return false;
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    return Math.hypot(x - MIDDLE.x, y - MIDDLE.y) < SAME_PLACE_PX;
  });
  await screenshot("26-pointer", student);
  await teacher.keyboard.press("Escape");
  await until("no pointer", async () => (await student.getByTestId("pointer").count()) === 0);
  await openTool(teacher, "look");
});

test("following locked, a student's drag does nothing but hint", async () => {
  await setRule("followingLocked", true);
  await student.waitForTimeout(300);
  const before = await azimuthOf(student);
  await turn(student, 120);
  await student.getByText("has locked the view").waitFor();
  await student.waitForTimeout(300);
  assert.equal(await azimuthOf(student), before);
  assert.equal(await student.getByTestId("looking-around").count(), 0);
  await setRule("followingLocked", false);
});

test("locking brings those back who look around", async () => {
  await turn(student, 120);
  await until("the own view", async () => (await canvasData(student)).ownView === "true");
  await setRule("followingLocked", true);
  await until("the teacher's view", async () => (await canvasData(student)).ownView === "false");
  await inStep();
  assert.equal(await azimuthOf(student), await azimuthOf(teacher));
  await setRule("followingLocked", false);
});

test("a hidden page gets no frames, and the newest one when it is seen again", async () => {
  const hide = (hidden) =>
    student.evaluate((now) => {
      Object.defineProperty(document, "hidden", { configurable: true, get: () => now });
      document.dispatchEvent(new Event("visibilitychange"));
    }, hidden);
  await hide(true);
  await teacher.getByTestId("people").click();
  await teacher.getByTestId("people-list").getByText("away").waitFor();
  await teacher.keyboard.press("Escape");
  const before = await canvasData(student);
  await changing(() => setNumber(teacher, "exposure", -0.5), teacher);
  assert.equal((await canvasData(student)).sequence, before.sequence);
  await hide(false);
  await inStep();
});

test("a student's name is seen by the teacher", async () => {
  await student.getByTestId("people").click();
  await student.getByTestId("own-name").fill("Ben");
  await student.getByTestId("own-name").press("Enter");
  await student.keyboard.press("Escape");
  await teacher.getByTestId("people").click();
  await teacher.getByTestId("people-list").getByText("Ben").waitFor();
  await screenshot("27-people", teacher);
  await teacher.keyboard.press("Escape");
});

test("the teacher reloads by accident and loses nothing", async () => {
  await teacher.waitForTimeout(1200);
  const before = await rested(teacher);
  const picture = await grabCanvas(teacher);
  await teacher.reload();
  await openTool(teacher, "look");
  const after = await rested(teacher);
  assert.equal(after.azimuth, before.azimuth);
  const apart = difference(picture, await grabCanvas(teacher));
  assert.ok(apart < 1, `after the reload the picture differs by ${apart}`);
  assert.equal(await exposure(teacher).inputValue(), "-0.5");
  assert.equal(await marksOn(teacher), 1);
  await teacher.getByTestId("edit-block").waitFor({ state: "detached" });
  await changing(() => setNumber(teacher, "exposure", 0), teacher);
  await inStep();
  await openTool(teacher, "marks");
  await teacher.getByTestId("clear-marks").click();
  await until("no marks", async () => (await marksOn(student)) === 0);
});

test("no error reached the browsers' consoles", () => {
  assert.deepEqual(complaints, []);
});

test("the teacher ends the session for everybody", async () => {
  await teacher.getByTestId("share").click();
  await teacher.getByTestId("end-session").click();
  assert.match(await teacher.getByTestId("end-session").innerText(), /everybody/);
  await teacher.getByTestId("end-session").click();
  await student.getByTestId("session-ended").waitFor();
  await screenshot("28-ended", student);
  await student.waitForTimeout(1000);
  assert.equal(await student.getByTestId("session-ended").count(), 1, "nothing is opened unasked");
  const { azimuth } = await canvasData(student);
  await student.getByTestId("open-new").click();
  await student.getByTestId("session-ended").waitFor({ state: "detached" });
  await until("a session of its own", async () => !(await exposure(student).isDisabled()));
  assert.equal((await rested(student)).azimuth, azimuth);
});
