// End-to-end test of a shared session: a teacher and students, each with a page, and the real server.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  azimuthOf,
  ClassRoom,
  controlLabel,
  drawLine,
  exposure,
  markOn,
  marksOn,
  MIDDLE,
  nameThemselves,
  NEVER,
  noticesOf,
  said,
  setRule,
  steers,
  turn,
  VIEWPORT,
} from "./class_room.mjs";
import { canvasData, changing, chooseQuality, grabRestingFrame, openTool, rested, screenshot, setNumber, until } from "./driver.mjs";
import { difference, grabCanvas } from "./pictures.mjs";
import { textOfCode } from "./qr.mjs";
import { countSceneUpdates } from "./socket_messages.mjs";

// Two places count as the same within this distance: half a pixel of error for each of them, plus the rounding of the
// overlay's numbers.
const SAME_PLACE_PX = 2;

const room = new ClassRoom();
let teacher;
let student;
let classmate;
// Returns how many scenes the student's page has sent.
let scenesOfStudent;

before(async () => {
  teacher = await room.open();
});

after(() => room.close());

function middleOf(points) {
  const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
  return [xs, ys].map((values) => (Math.min(...values) + Math.max(...values)) / 2);
}

// Records the revisions that the page shows from now on, and the time at which it first showed each.
const noteWhenShown = (page) =>
  page.getByTestId("storm-canvas").evaluate((canvas) => {
    window.shownAt = {};
    new MutationObserver(() => {
      window.shownAt[canvas.dataset.revision] ??= Date.now();
    }).observe(canvas, { attributeFilter: ["data-revision"] });
  });

test("a presenter leaves: a request that nobody answers ends, and control is free later", async () => {
  const presenter = await room.visit(room.server.url);
  await until("a session", async () => presenter.url().includes("?session="));
  // With another quality the server would trace light for this page's picture all the time, although the test does not
  // need it.
  await chooseQuality(presenter, "Fast");
  await setRule(presenter, "freeWhenAway", true);
  const viewer = await room.visit(presenter.url().replace(/#.*/, ""));
  await viewer.getByTestId("ask-control").waitFor();
  await presenter.context().close();
  await until("a presenter who is gone", async () => (await said(viewer)) === "Waiting for Presenter to come back");
  await room.whileWaiting({ come_back: 0 }, () =>
    until("a presenter who is away", async () => (await said(viewer)) === "No one steers"),
  );
  const keptForPresenter = async () => {
    assert.match(await viewer.getByTestId("edit-block").innerText(), /away, and keeps control/);
    assert.equal(await controlLabel(viewer), "Ask to steer");
  };
  await keptForPresenter();
  await viewer.getByTestId("ask-control").click();
  await until("a request", async () => (await controlLabel(viewer)) === "Asked to steer …");
  await room.whileWaiting({ answer: 0 }, () =>
    until("the request's end", async () => (await controlLabel(viewer)) !== "Asked to steer …"),
  );
  await keptForPresenter();
  await room.whileWaiting({ away: 0 }, () => until("free control", async () => (await controlLabel(viewer)) === "Steer"));
  await viewer.getByTestId("ask-control").click();
  await viewer.getByTestId("give-back").waitFor();
  await changing(() => setNumber(viewer, "exposure", 0.6), viewer);
  await viewer.context().close();
});

test("the teacher shares a link and a code, and keeps the presenter's key", async () => {
  await teacher.getByTestId("share").click();
  await screenshot("20-share", teacher);
  const link = await teacher.getByTestId("viewers-link").inputValue();
  assert.match(link, /\?session=[^&#]+$/);
  assert.equal(await textOfCode(teacher), link);
  await teacher.getByTestId("qr").click();
  assert.equal(await textOfCode(teacher), link, "as large as the window");
  await teacher.getByTestId("qr").click();
  assert.match(await teacher.getByTestId("only-here").innerText(), /127\.0\.0\.1 is only this computer/);
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
  student = await room.visit(await room.viewersLink(), (page) => {
    scenesOfStudent = countSceneUpdates(page);
  });
  await room.inStep(student);
  const [{ picture: teachers }, { picture: students }] = [await grabRestingFrame(teacher), await grabRestingFrame(student)];
  const apart = difference(teachers, students);
  assert.ok(apart < 1, `the pictures differ by ${apart}`);
  for (const page of [teacher, student]) await noteWhenShown(page);
  await changing(() => setNumber(teacher, "exposure", 0.7), teacher);
  await room.inStep(student);
  const { revision: shown } = await canvasData(teacher);
  const shownAt = (page) => page.evaluate((revision) => window.shownAt[revision], shown);
  const apartMs = (await shownAt(student)) - (await shownAt(teacher));
  console.log(`figure: a student's picture after the teacher's: ${apartMs} ms`);
  assert.equal(await exposure(student).inputValue(), "0.7");
  assert.equal(await exposure(student).isDisabled(), true);
  assert.equal(await student.getByTestId("exposure").isDisabled(), true);
  assert.match(await student.getByTestId("edit-block").innerText(), /steers/);
  assert.equal(await exposure(teacher).isDisabled(), false);
  const { revision } = await canvasData(teacher);
  const sent = scenesOfStudent();
  await student.keyboard.press(".");
  await openTool(student, "light");
  await student.getByTestId("sun-dome").press("ArrowDown");
  await openTool(student, "look");
  // The server handles a page's messages in order. When the teacher sees the new name, all earlier messages of the
  // student's page have been handled.
  await nameThemselves(student, "Ann");
  await room.teacherSees("Ann");
  assert.equal(scenesOfStudent(), sent, "the page sends a scene");
  assert.equal((await canvasData(teacher)).revision, revision);
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
  // The own view has the same storm, time and light: the teacher's changes appear in it.
  await rested(student);
  const own = await grabCanvas(student);
  await changing(() => setNumber(teacher, "exposure", -1.5), teacher);
  await until("the own view darker", async () => difference(own, await grabCanvas(student)) > 3);
  assert.equal((await canvasData(student)).ownView, "true");
  await student.getByTestId("follow").click();
  await until("the teacher's view", async () => (await canvasData(student)).ownView === "false");
  await room.inStep(student);
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
  await room.inStep(student);
  assert.equal(await exposure(teacher).inputValue(), "0.4");
  const before = await azimuthOf(teacher);
  await changing(() => turn(student, 60), student);
  await room.inStep(student);
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
  await student.getByTestId("ask-control").click();
  await teacher.getByTestId("asks-give-not").click();
  await teacher.getByTestId("asks").waitFor({ state: "detached" });
  assert.equal(await student.getByTestId("give-back").count(), 0);
  // A second request for control right after the first one does not reach the teacher.
  await until("a button", async () => (await controlLabel(student)) === "Ask to steer");
  await room.whileWaiting({ ask_again: NEVER }, async () => {
    await student.getByTestId("ask-control").click();
    await student.getByText("asked for control a moment ago").waitFor();
  });
  await setRule(teacher, "controlLocked", true);
  await until("a locked button", () => student.getByTestId("ask-control").isDisabled());
  await setRule(teacher, "controlLocked", false);
  await until("an unlocked button", () => student.getByTestId("ask-control").isEnabled());
  // The teacher's page has received a presence message since the request.
  assert.equal(await teacher.getByTestId("asks").count(), 0);
});

test("control that the teacher lets go is free: one of two who ask at once steers, the other asks that one", async () => {
  classmate = await room.visit(await room.viewersLink());
  await classmate.getByTestId("ask-control").waitFor();
  await teacher.getByTestId("let-go").focus();
  await teacher.keyboard.press("Enter");
  await teacher.getByTestId("take-control").waitFor();
  const focused = await teacher.evaluate(() => document.activeElement?.dataset.testid);
  assert.equal(focused, "take-control", "the keyboard's place is lost");
  assert.equal(await said(teacher), "No one steers");
  assert.equal(await exposure(teacher).isDisabled(), true);
  for (const page of [student, classmate])
    await until("free control", async () => (await controlLabel(page)) === "Steer");
  await screenshot("23b-free-control", student);
  await Promise.all([student, classmate].map((page) => page.getByTestId("ask-control").click()));
  await until("one who steers", async () => (await steers(student)) || (await steers(classmate)));
  const [first, second] = (await steers(student)) ? [student, classmate] : [classmate, student];
  await first.getByTestId("asks-give").waitFor();
  assert.equal(await steers(second), false);
  assert.equal(await controlLabel(second), "Asked to steer …");
  assert.equal(await exposure(second).isDisabled(), true);
  await changing(() => setNumber(first, "exposure", 0.2), first);
  await first.getByTestId("asks-give").click();
  await second.getByTestId("give-back").waitFor();
  await first.getByTestId("ask-control").waitFor();
  assert.equal(await exposure(second).inputValue(), "0.2");
  await second.getByTestId("give-back").click();
  await teacher.getByTestId("let-go").waitFor();
  assert.equal(await exposure(teacher).isDisabled(), false);
});

test("where viewers may not steer, whoever asks for free control waits for the teacher", async () => {
  await setRule(teacher, "viewersMaySteer", false);
  await teacher.getByTestId("let-go").click();
  await until("nobody", async () => (await said(classmate)) === "No one steers");
  assert.equal(await controlLabel(classmate), "Ask to steer");
  await classmate.getByTestId("ask-control").click();
  await teacher.getByTestId("asks-give").waitFor();
  assert.equal(await said(student), "No one steers");
  await teacher.getByTestId("asks-give").click();
  await classmate.getByTestId("give-back").waitFor();
  await teacher.getByTestId("take-control").click();
  await classmate.getByTestId("ask-control").waitFor();
  await setRule(teacher, "viewersMaySteer", true);
});

test("a line that the teacher draws is on the student's picture at the same place, and stays on the storm", async () => {
  await room.inStep(student);
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
  await room.inStep(student);
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
  // The test uses only the keyboard here.
  await teacher.getByTestId("tool-pointer").focus();
  await teacher.keyboard.press("Enter");
  await teacher.getByTestId("mark-middle").focus();
  await teacher.keyboard.press("Enter");
  await student.getByTestId("pointer").waitFor();
  await teacher.keyboard.press("Escape");
  await until("no pointer", async () => (await student.getByTestId("pointer").count()) === 0);
  await openTool(teacher, "look");
});

test("a student points and draws while the teacher allows it", async () => {
  await openTool(student, "marks");
  await student.getByText("has not allowed viewers to point and draw").waitFor();
  assert.equal(await student.getByTestId("tool-pen").count(), 0);
  await setRule(teacher, "viewersMayMark", true);
  await student.getByTestId("tool-pen").click();
  await room.inStep(student);
  for (const y of [190, 250]) await drawLine(student, { x: MIDDLE.x, y });
  for (const page of [teacher, student, classmate])
    await until("both lines and the teacher's", async () => (await marksOn(page)) === 3);
  const last = (page) =>
    page.getByTestId("mark").last().evaluate(({ dataset }) => dataset.corners);
  assert.equal(await last(teacher), await last(student));
  const [, y] = middleOf((await last(teacher)).split(" ").map((corner) => corner.split(",").map(Number)));
  assert.ok(Math.abs(y - 255) < 10, `the line is at ${y}`);
  // Marks added while the first is being placed are refused, and sent again.
  await student.getByTestId("mark-middle").evaluate((button) => {
    for (let i = 0; i < 3; i += 1) button.click();
  });
  for (const page of [teacher, classmate])
    await until("three rings more", async () => (await marksOn(page)) === 6);
  assert.equal(await student.getByTestId("pending-mark").count(), 0);
  await student.getByTestId("tool-pointer").click();
  await student.mouse.move(MIDDLE.x - 10, MIDDLE.y);
  await student.mouse.move(MIDDLE.x, MIDDLE.y);
  for (const page of [teacher, classmate]) await page.getByTestId("pointer").waitFor();
  await screenshot("26b-students-marks", teacher);

  await setRule(teacher, "viewersMayMark", false);
  for (const page of [teacher, classmate]) await page.getByTestId("pointer").waitFor({ state: "detached" });
  await student.getByText("has not allowed viewers to point and draw").waitFor();
  await student.mouse.move(MIDDLE.x + 5, MIDDLE.y);
  // The server handles a page's messages in order, so it has handled everything that the student's page sent before the
  // name. The server would send a pointer of the student together with the teacher's pointer.
  await nameThemselves(student, "Bea");
  await room.teacherSees("Bea");
  await openTool(teacher, "marks");
  await teacher.getByTestId("tool-pointer").click();
  await teacher.mouse.move(MIDDLE.x - 10, MIDDLE.y);
  await teacher.mouse.move(MIDDLE.x, MIDDLE.y);
  await classmate.getByTestId("pointer").waitFor();
  assert.equal(await classmate.getByTestId("pointer").count(), 1, "the student's pointer is seen");
  await teacher.keyboard.press("Escape");
  await classmate.getByTestId("pointer").waitFor({ state: "detached" });
  await openTool(teacher, "look");

  // The viewer who has control may draw, whatever the rule says. A viewer can erase only their own marks.
  await teacher.getByTestId("people").click();
  await teacher.getByTestId("give-unasked").first().click();
  await teacher.keyboard.press("Escape");
  await student.getByTestId("give-back").waitFor();
  assert.equal(await student.getByTestId("tool-pen").count(), 1);
  await student.getByTestId("clear-marks").click();
  await until("the teacher's line alone", async () => (await marksOn(teacher)) === 1);
  await teacher.getByTestId("take-control").click();
  await student.getByTestId("ask-control").waitFor();
  await openTool(student, "look");
});

test("following locked, a student's drag does nothing but hint", async () => {
  await room.setRuleFor(student, "followingLocked", true);
  const before = await azimuthOf(student);
  await turn(student, 120);
  await student.getByText("has locked the view").waitFor();
  // The student's view stays unchanged in the next picture, too.
  await changing(() => setNumber(teacher, "exposure", -1.2), teacher);
  await room.inStep(student);
  assert.equal(await azimuthOf(student), before);
  assert.equal((await canvasData(student)).ownView, "false");
  assert.equal(await student.getByTestId("looking-around").count(), 0);
  await room.setRuleFor(student, "followingLocked", false);
});

test("locking brings those back who look around", async () => {
  await turn(student, 120);
  await until("the own view", async () => (await canvasData(student)).ownView === "true");
  await setRule(teacher, "followingLocked", true);
  await until("the teacher's view", async () => (await canvasData(student)).ownView === "false");
  await room.inStep(student);
  assert.equal(await azimuthOf(student), await azimuthOf(teacher));
  await room.setRuleFor(student, "followingLocked", false);
});

test("those who look around are told that others do, and why that is slower", async () => {
  await turn(student, 80);
  await until("the own view", async () => (await canvasData(student)).ownView === "true");
  assert.match(await student.getByTestId("looking-around").innerText(), /^Looking around\s+Back/);
  await turn(classmate, -80);
  for (const page of [student, classmate]) await page.getByText("2 look around").waitFor();
  await student.getByTestId("readout-summary").click();
  assert.match(await student.getByTestId("own-view").innerText(), /2 people look around and share/);
  await screenshot("26c-two-look-around", student);
  await student.getByTestId("readout-summary").click();
  for (const page of [student, classmate]) await page.getByTestId("follow").click();
  await room.inStep(student);
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
  await noteWhenShown(student);
  const { revision: missed } = await changing(() => setNumber(teacher, "exposure", -0.8), teacher);
  await changing(() => setNumber(teacher, "exposure", -0.5), teacher);
  assert.equal((await canvasData(student)).revision, before.revision);
  await hide(false);
  await room.inStep(student);
  const shown = await student.evaluate(() => Object.keys(window.shownAt));
  assert.ok(!shown.includes(missed), `${missed} is one of ${shown}`);
});

test("a student's name is seen by the teacher", async () => {
  await nameThemselves(student, "Ben");
  await room.teacherSees("Ben", "27-people");
});

test("the teacher reloads by accident and loses nothing", async () => {
  const { data: before, picture } = await grabRestingFrame(teacher);
  await teacher.reload();
  await openTool(teacher, "look");
  const { data: after } = await grabRestingFrame(teacher);
  assert.equal(after.azimuth, before.azimuth);
  // After the reload the page sends its size again, so one more frame may follow before the picture is as before.
  await until("the picture as before", async () => difference(picture, await grabCanvas(teacher)) < 0.5);
  assert.equal(await exposure(teacher).inputValue(), "-0.5");
  assert.equal(await marksOn(teacher), 1);
  await teacher.getByTestId("edit-block").waitFor({ state: "detached" });
  await changing(() => setNumber(teacher, "exposure", 0), teacher);
  await room.inStep(student);
  await openTool(teacher, "marks");
  await teacher.getByTestId("clear-marks").click();
  await until("no marks", async () => (await marksOn(student)) === 0);
  await openTool(teacher, "look");
});

test("a colleague presents by the presenter's link; of two who steer at once nobody loses a change without a word", async () => {
  await teacher.getByTestId("share").click();
  assert.equal(await teacher.getByTestId("presenters-link").count(), 0, "it is folded up");
  await teacher.getByTestId("present-too").locator("summary").click();
  const link = await teacher.getByTestId("presenters-link").inputValue();
  await screenshot("27b-presenters-link", teacher);
  await teacher.keyboard.press("Escape");
  const key = new URLSearchParams(new URL(link).hash.slice(1)).get("present");
  assert.ok(key.length > 10);
  assert.ok(!(await room.viewersLink()).includes(key));

  await classmate.context().close();
  const colleague = await room.visit(link);
  await colleague.getByTestId("take-control").waitFor();
  assert.ok(!colleague.url().includes(key), "the key is in the address");
  for (const page of [colleague, student]) {
    await until("two presenters", async () => (await said(page)) === "Presenter steers");
  }

  await Promise.all([
    setNumber(teacher, "exposure", 0.9),
    colleague.getByTestId("take-control").click(),
  ]);
  await colleague.getByTestId("let-go").waitFor();
  await teacher.getByTestId("take-control").waitFor();
  await until("the same on both pages", async () => {
    const [one, other] = [await canvasData(teacher), await canvasData(colleague)];
    const values = [await exposure(teacher).inputValue(), await exposure(colleague).inputValue()];
    return one.revision === other.revision && other.refined === "true" && values[0] === values[1];
  });
  const mine = await exposure(teacher).inputValue();
  if (mine === "0.9") assert.doesNotMatch(await noticesOf(teacher), /last change was not made/);
  else assert.match(await noticesOf(teacher), /last change was not made|is in control/);

  await changing(() => setNumber(colleague, "exposure", 0.3), colleague);
  await until("the colleague's change", async () => (await exposure(teacher).inputValue()) === "0.3");
  // Two people act at the same time. One of them gets control, and all pages show the same person.
  await colleague.getByTestId("let-go").click();
  await teacher.getByTestId("take-control").waitFor();
  await Promise.all([teacher, colleague].map((page) => page.getByTestId("take-control").click()));
  await until("one who steers", async () => {
    const both = await Promise.all([teacher, colleague].map((page) => page.getByTestId("let-go").count()));
    return both[0] + both[1] === 1;
  });
  await colleague.context().close();
  // Control returns to the presenter who is still there.
  await room.whileWaiting({ come_back: 0 }, () => teacher.getByTestId("let-go").waitFor());
});

test("no error reached the browsers' consoles", () => {
  assert.deepEqual(room.complaints, []);
});

test("the teacher ends the session for everybody", async () => {
  await teacher.getByTestId("share").click();
  await teacher.getByTestId("end-session").click();
  assert.match(await teacher.getByTestId("end-session").innerText(), /everyone/);
  await teacher.getByTestId("end-session").click();
  await student.getByTestId("session-ended").waitFor();
  await screenshot("28-ended", student);
  const { azimuth } = await canvasData(student);
  const opened = [];
  student.on("request", (request) => request.url().endsWith("/CreateSession") && opened.push(request.url()));
  await student.getByTestId("open-new").click();
  await student.getByTestId("session-ended").waitFor({ state: "detached" });
  await until("a session of its own", async () => !(await exposure(student).isDisabled()));
  assert.equal((await rested(student)).azimuth, azimuth);
  assert.equal(opened.length, 1, "nothing is opened unasked");
});
