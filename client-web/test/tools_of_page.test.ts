// Tests of the tools' wiring with the fake service, in simulated time: links to a view, the probe,
// the map, undo, notices.
import { create } from "@bufbuild/protobuf";
import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { FIRST_ANNOTATIONS } from "../src/core/annotations";
import { type Pose, poseOfCamera } from "../src/core/camera";
import { joined, letterStrokes } from "../src/core/lettering";
import { Marking } from "../src/core/marking";
import type { WorldRay } from "../src/core/projection";
import { withDisplay, withField } from "../src/core/scene";
import { sceneToText } from "../src/core/scene_file";
import { lengthUnits } from "../src/core/units";
import { Hydrometeor, SceneSchema } from "../src/gen/thunderhead/v1/scene_pb";
import { readLink } from "../src/view/link";
import { FakeCanvas, FakeStorage } from "./fake_window";
import { HOME, pass, Visits } from "./view_page";

let visits: Visits;
beforeEach(() => {
  visits = new Visits();
});
afterEach(() => visits.end());

const classroom = async () => {
  const teacher = await visits.visit();
  const viewer = await visits.visit(teacher.page.addresses.viewersLink(true));
  return { teacher, viewer };
};

const TURN = [
  [100, 100],
  [136, 100],
] as const;

it("a link to a view opens that view in a session of its own, also one's own view", async () => {
  const { viewer } = await classroom();
  viewer.canvas.dragOver(TURN);
  await pass(200);
  expect(viewer.page.state.session.lookingAround.value).toBe(true);
  const link = viewer.page.addresses.viewLink(viewer.page.keeper.sceneShown());
  expect(readLink(link).viewerKey).toBeUndefined();
  expect(link.startsWith(`${HOME}#scene=`)).toBe(true);
  const other = await visits.visit(link);
  expect(visits.service.sessions).toHaveLength(2);
  expect(other.canvas.dataset.azimuth).toBe("218.00");
  expect(poseOfCamera(visits.session.scene.camera)).toMatchObject({ azimuthDeg: 200 });
});

it("who looks around hears of the own view, not of the presenter's", async () => {
  const { viewer } = await classroom();
  expect(viewer.page.state.description.value).toContain("(200°)");
  viewer.canvas.dragOver(TURN);
  await pass(200);
  expect(viewer.page.state.description.value).toContain("(218°)");
});

it("what the probe found goes with the time and with the storm", async () => {
  const { page } = await visits.visit();
  const probe = async () => {
    await page.probing.through({ x: 0, y: 0 });
    expect(page.state.probes.value).toHaveLength(1);
  };
  await probe();
  page.showTime(1);
  expect(page.state.probes.value).toEqual([]);
  await probe();
  await page.showStorm("single");
  expect(page.state.probes.value).toEqual([]);
  const late = page.probing.through({ x: 0, y: 0 });
  await page.showStorm("supercell");
  await late;
  expect(page.state.probes.value).toEqual([]);
});

it("another run of the same model is seen from the same place, with the same settings", async () => {
  const { page } = await visits.visit();
  visits.service.grow();
  await pass(1000);
  const pose = page.state.pose.value;
  page.move((from) => ({ ...from, azimuthDeg: 77 }) as Pose);
  page.state.edit((scene) => withField(scene, Hydrometeor.RAIN, { visible: false }));
  page.showTime(2);
  await pass(1000);
  await page.showStorm("late");
  await pass(1000);
  const rain = () =>
    page.state.fields.value.find(({ hydrometeor }) => hydrometeor === Hydrometeor.RAIN)?.visible;
  expect(page.state.stormId.value).toBe("late");
  expect(page.state.pose.value).toEqual({ ...pose, azimuthDeg: 77 });
  expect(rain()).toBe(false);
  expect(page.state.timeIndex.value).toBe(0);
  await page.showStorm("single");
  await pass(1000);
  expect(page.state.pose.value).not.toEqual({ ...pose, azimuthDeg: 77 });
  expect(rain()).not.toBe(false);
});

it("of two storms that are chosen at once the last is shown", async () => {
  const { page } = await visits.visit();
  visits.service.grow();
  await pass(1000);
  await Promise.all([page.showStorm("late"), page.showStorm("single")]);
  expect(page.state.stormId.value).toBe("single");
});

it("a step in time ends play, as does a file that is opened", async () => {
  const { page } = await visits.visit();
  page.playback.play();
  page.playback.step(1);
  expect(page.playback.playing.value).toBe(false);
  page.playback.play();
  await page.keeper.open(new File([sceneToText(page.state.scene.value)], "a.json"));
  expect(page.playback.playing.value).toBe(false);
});

it("words stay in the picture, whole", async () => {
  const { page } = await visits.visit();
  const box = { left: 100, top: 50, width: 300, height: 200 };
  const projection = page.state.frame.value?.projection;
  if (projection === undefined) throw new Error("no picture");
  const rays: (readonly WorldRay[])[] = [];
  const marking = new Marking(page.state.session, {
    picture: () => ({ box, projection, distanceM: 1 }),
    point: () => undefined,
    addMark: (all) => BigInt(rays.push(all)),
    later: () => () => undefined,
  });
  const written = (words: string) => joined(letterStrokes(words, { left: 0, top: 0 }, 12)).length;
  for (const words of ["HAIL 2 CM", "ROTATING WALL CLOUD AND TAIL CLOUD"]) {
    marking.words.value = words;
    // One text is at an edge, and one in the middle.
    marking.write({ left: 395, top: 52 });
    marking.markMiddle("text");
    for (const each of rays.splice(0)) expect(each).toHaveLength(written(words));
  }
});

it("B that cannot be opened says why, also where no session may be opened", async () => {
  const { page } = await visits.visit();
  vi.stubGlobal("window", { devicePixelRatio: 1 });
  vi.stubGlobal("document", { hidden: false });
  page.comparing.attach(new FakeCanvas() as never);
  page.comparing.change({});
  await pass(1000);
  expect(page.comparing.interrupted.value).toBeUndefined();
  page.comparing.end();
  visits.network.locked = true;
  page.comparing.change({});
  await pass(1000);
  expect(page.comparing.interrupted.value).toBe("this server needs a token");
  page.comparing.end();
  expect(page.comparing.interrupted.value).toBeUndefined();
});

it("no cores of another time stay where the map of this one does not come", async () => {
  const { page } = await visits.visit();
  page.toggleTool("probe");
  await pass(500);
  expect(page.state.stormMap.value?.timeIndex).toBe(page.state.timeIndex.value);
  visits.service.mapless = true;
  page.showTime(1);
  await pass(1000);
  expect(page.state.stormMap.value).toBeUndefined();
  expect(page.state.mapProblem.value).toMatch(/could not send the map: the file is gone/);
});

it("playing is not undone time by time", async () => {
  const { page } = await visits.visit();
  page.playback.play();
  await pass(3000);
  page.playback.pause();
  expect(page.state.history.canUndo.value).toBe(false);
  page.playback.step(1);
  expect(page.state.history.canUndo.value).toBe(true);
});

it("undo leaves what another person changed meanwhile, and does not reach into another storm", async () => {
  const { page } = await visits.visit();
  page.state.edit((scene) => withDisplay(scene, { exposureEv: 2 }));
  await pass(1000);
  const { session } = visits;
  session.changeScene({ ...session.scene, timeIndex: 2 });
  await pass(1000);
  expect(page.state.timeIndex.value).toBe(2);
  page.state.undo();
  await pass(1000);
  expect(session.scene.display?.exposureEv ?? 0).toBe(0);
  expect(session.scene.timeIndex).toBe(2);
  page.state.redo();
  await pass(1000);
  session.changeScene(create(SceneSchema, { stormId: "single" }));
  await pass(1000);
  expect(page.state.history.canUndo.value).toBe(false);
});

it("the fields of a storm that is switched to are completed as the technique is", async () => {
  const { page } = await visits.visit();
  const count = page.state.fields.value.length;
  expect(count).toBeGreaterThan(0);
  await page.showStorm("single");
  expect(page.state.fields.value).toHaveLength(0);
  await pass(1000);
  expect(page.state.fields.value).toHaveLength(count);
});

it("a problem stays though a note on the same subject came just before it", async () => {
  const { page } = await visits.visit();
  page.notes.say("file", "The view of a.png");
  await pass(3000);
  page.notes.problem("file", "b.png is not opened");
  await pass(4000);
  expect(page.state.notices.value.map(({ text }) => text)).toEqual(["b.png is not opened"]);
  page.notes.say("file", "The view of c.png");
  await pass(3000);
  page.notes.say("file", "The view of d.png");
  await pass(4000);
  expect(page.state.notices.value).toHaveLength(1);
  await pass(3000);
  expect(page.state.notices.value).toHaveLength(0);
});

it("a named view brings its time back too; who looks around gets its camera", async () => {
  const { teacher, viewer } = await classroom();
  teacher.page.showTime(2);
  await pass(500);
  const camera = teacher.page.state.scene.value.camera;
  if (camera === undefined) throw new Error("there is no camera");
  teacher.page.showTime(0);
  await pass(500);
  const view = { name: "a", camera, validTime: "", picture: "" };
  viewer.page.showView({ ...view, timeIndex: 2 });
  await pass(500);
  expect(viewer.page.state.session.lookingAround.value).toBe(true);
  expect(visits.session.scene.timeIndex ?? 0).toBe(0);
  teacher.page.showView({ ...view, timeIndex: 99 });
  await pass(500);
  expect(visits.session.scene.timeIndex).toBe(3);
});

it("units and what is written over the picture outlast the page", async () => {
  const storage = new FakeStorage();
  const { page } = await visits.visit(HOME, storage);
  lengthUnits.value = "aviation";
  page.state.annotations.value = { ...page.state.annotations.value, rings: true };
  page.dispose();
  lengthUnits.value = "metric";
  const again = await visits.visit(HOME, storage);
  expect(lengthUnits.value).toBe("aviation");
  expect(again.page.state.annotations.value).toEqual({ ...FIRST_ANNOTATIONS, rings: true });
  lengthUnits.value = "metric";
  storage.items.set("thunderhead.preferences", '{"units":"ells","annotations":7}');
  expect((await visits.visit(HOME, storage)).page.state.annotations.value).toEqual(
    FIRST_ANNOTATIONS,
  );
  expect(lengthUnits.value).toBe("metric");
});

it("B waits for its storm's times, and says where they do not come", async () => {
  const { page } = await visits.visit();
  vi.stubGlobal("window", { devicePixelRatio: 1 });
  vi.stubGlobal("document", { hidden: false });
  page.comparing.attach(new FakeCanvas() as never);
  page.comparing.change({ stormId: "single" });
  expect(visits.service.sessions).toHaveLength(1);
  await pass(1000);
  expect(visits.service.sessions).toHaveLength(2);
  expect(page.comparing.time.value.index).toBe(0);
  page.comparing.end();
  visits.service.undescribed = "single";
  page.comparing.change({ stormId: "single" });
  await pass(1000);
  expect(page.comparing.undescribed.value).toBe("The times of B are not known: the file is gone");
});
