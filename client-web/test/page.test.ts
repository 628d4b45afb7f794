// Tests of the page's wiring without its widgets: a teacher's and viewers' pages with the fake
// service, in simulated time.
import { create } from "@bufbuild/protobuf";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { poseOfCamera } from "../src/core/camera";
import { withSky, withTime } from "../src/core/scene";
import {
  type InteractRequest,
  InteractRequestSchema,
  Role,
  TimesInMemorySchema,
} from "../src/gen/thunderhead/v1/interact_pb";
import { Page } from "../src/view/page";
import { FakeNetwork } from "./fake_network";
import { END_NOT_SAVED, FakeService } from "./fake_service";
import { FakeCanvas, FakeStorage, FakeWindow, stubGlobals } from "./fake_window";

const HOME = "http://host/storms/";

interface Place {
  readonly page: Page;
  readonly canvas: FakeCanvas;
  readonly window: FakeWindow;
  readonly storage: FakeStorage;
}

const pass = (ms: number) => vi.advanceTimersByTimeAsync(ms);

describe("the page in a session", () => {
  let service: FakeService;
  let network: FakeNetwork;
  const pages: Page[] = [];

  beforeEach(() => {
    vi.useFakeTimers();
    stubGlobals();
    service = new FakeService(() => new Uint8Array([1]));
    network = new FakeNetwork(service);
  });
  afterEach(() => {
    for (const page of pages.splice(0)) page.dispose();
    vi.unstubAllGlobals();
    vi.useRealTimers();
  });

  async function visit(address = HOME, storage = new FakeStorage()): Promise<Place> {
    const window = new FakeWindow(address, storage);
    const page = new Page(network.transport(), network.openInteract, window as never);
    pages.push(page);
    const canvas = new FakeCanvas();
    page.attachCanvas(canvas as never);
    await pass(600);
    return { page, canvas, window, storage };
  }

  const leave = (place: Place) => {
    pages.splice(pages.indexOf(place.page), 1);
    place.page.dispose();
  };

  const reload = (place: Place) => {
    leave(place);
    return visit(place.window.location.href, place.storage);
  };

  const session = () => {
    const first = service.sessions[0];
    if (first === undefined) throw new Error("there is no session");
    return first;
  };

  const classroom = async () => {
    const teacher = await visit();
    const viewer = await visit(teacher.page.addresses.viewersLink(true));
    return { teacher, viewer };
  };

  // Returns the messages of the newest person after joining.
  const said = (at = -1): InteractRequest["message"][] =>
    session()
      .people.at(at)
      ?.heard.map(({ message }) => message) ?? [];
  const notices = ({ page }: Place) => page.state.notices.value.map(({ text }) => text).join();
  const saidOf = (subject: string, at = -1) =>
    said(at).filter((message) => message.case === subject);

  it("opens a session, has the viewers' key in its address and the presenter's nowhere in it", async () => {
    const { window, storage, page } = await visit();
    const address = new URL(window.location.href);
    expect(address.searchParams.get("session")).toBe(session().viewerKey);
    expect(window.location.href).not.toContain(session().presenterKey);
    expect([...storage.items.values()].join()).toContain(session().presenterKey);
    expect(page.addresses.viewersLink()).toBe(`${HOME}?session=${session().viewerKey}`);
    expect(page.state.session.steering.value).toBe(true);
  });

  it("is presenter again after a reload, with the scene, and ends nothing by it", async () => {
    const before = await visit();
    before.page.showTime(2);
    await pass(2000);
    const after = await reload(before);
    expect(service.sessions).toHaveLength(1);
    expect(after.page.state.session.presenting.value).toBe(true);
    expect(after.page.state.session.steering.value).toBe(true);
    expect(after.page.state.timeIndex.value).toBe(2);
    expect(network.called).not.toContain("CloseSession");
  });

  it("hands presenting on by a link whose key goes from the address at once, and to nobody else", async () => {
    const { teacher, viewer } = await classroom();
    expect(viewer.page.addresses.presentersLink()).toBeUndefined();
    const link = teacher.page.addresses.presentersLink() ?? "";
    expect(new URL(link).hash).toBe(`#present=${session().presenterKey}`);
    expect(teacher.page.addresses.viewersLink(true)).not.toContain(session().presenterKey);

    const second = await visit(link);
    expect(second.page.state.session.presenting.value).toBe(true);
    expect(second.window.location.href).not.toContain(session().presenterKey);
    expect(teacher.page.state.session.steering.value).toBe(true);
    second.page.actions.takeControl();
    await pass(50);
    expect(second.page.state.session.steering.value).toBe(true);
    const again = await reload(second);
    expect(again.page.state.session.presenting.value).toBe(true);
    expect(service.sessions).toHaveLength(1);
  });

  it("presents after a presenter's link is opened in a viewer's page", async () => {
    const { teacher, viewer } = await classroom();
    viewer.window.tell("hashchange");
    expect(viewer.window.reloads).toBe(0);
    viewer.window.location.href = teacher.page.addresses.presentersLink() ?? "";
    viewer.window.tell("hashchange");
    expect(viewer.window.reloads).toBe(1);
    expect(viewer.window.location.href).not.toContain(session().presenterKey);
    const after = await reload(viewer);
    expect(after.page.state.session.presenting.value).toBe(true);
  });

  it("keeps its own key against a link with another", async () => {
    const teacher = await visit();
    const { viewerKey } = session();
    leave(teacher);
    const again = await visit(`${HOME}?session=${viewerKey}#present=made-up`, teacher.storage);
    expect(again.page.state.session.presenting.value).toBe(true);
    expect(service.sessions).toHaveLength(1);
  });

  it("says which links open for nobody else", async () => {
    const here = [
      "localhost:8080",
      "a.localhost",
      "127.0.0.1:8080",
      "127.8.0.1",
      "[::1]",
      "0.0.0.0",
    ];
    for (const host of here) {
      const { page } = await visit(`http://${host}/`);
      expect(page.addresses.loopbackHost, host).toBe(new URL(`http://${host}`).hostname);
    }
    const reached = [
      "storms.example",
      "192.168.1.20:8080",
      "[fd00::1]",
      "localhost.example",
      "10.127.0.1",
    ];
    for (const host of reached) {
      const { page } = await visit(`https://${host}/`);
      expect(page.addresses.loopbackHost, host).toBeUndefined();
    }
  });

  it("shows times and storms that come while it is open", async () => {
    const { page } = await visit();
    const camera = page.state.scene.value.camera;
    expect(page.state.timeCount.value).toBe(4);
    service.grow();
    await pass(100);
    expect(page.state.timeCount.value).toBe(5);
    expect(page.state.storms.value.map(({ id }) => id)).toContain("late");
    expect(page.state.scene.value.camera).toEqual(camera);
  });

  it("tells what was assumed of the storm that is chosen", async () => {
    const { page } = await visit();
    expect(page.state.assumptions.value).toEqual([]);
    service.grow();
    await pass(100);
    page.showStorm("late");
    await pass(300);
    expect(page.state.assumptions.value).toEqual(["Mixing ratios are per kg of dry air."]);
  });

  it("knows which times of the storm shown are in the server's memory", async () => {
    const { teacher, viewer } = await classroom();
    const first = teacher.page.state.timeIndex.value;
    expect(viewer.page.state.heldTimes.value).toEqual([first, first + 1]);
    teacher.page.showTime(0);
    await pass(300);
    for (const { page } of [teacher, viewer])
      expect(page.state.heldTimes.value).toEqual([...new Set([0, 1, first, first + 1])]);
    // Times of another storm must not be shown for this storm.
    session().held.stormId = "another";
    viewer.page.state.timesInMemory.value = create(TimesInMemorySchema, session().held);
    expect(viewer.page.state.heldTimes.value).toEqual([]);
  });

  it("joins by the link as a viewer, who sees the scene and cannot change it", async () => {
    const { teacher, viewer } = await classroom();
    expect(viewer.page.state.session.presenting.value).toBe(false);
    expect(viewer.page.state.session.editBlock.value).toBe("Presenter steers.");
    viewer.page.showTime(3);
    teacher.page.showTime(1);
    await pass(400);
    expect(saidOf("updateScene")).toEqual([]);
    expect(viewer.page.state.timeIndex.value).toBe(1);
    expect(viewer.canvas.dataset.revision).toBe(teacher.canvas.dataset.revision);
    expect(viewer.canvas.dataset.time).toBe("1");
  });

  it("looks around by a drag, and comes back by a button", async () => {
    const { teacher, viewer } = await classroom();
    viewer.canvas.dragOver([
      [100, 100],
      [136, 100],
    ]);
    expect(viewer.page.state.session.lookingAround.value).toBe(true);
    await pass(200);
    const [detach] = saidOf("detach");
    const camera = detach?.case === "detach" ? detach.value.camera : undefined;
    const pose = poseOfCamera(camera);
    // A drag across the picture's height of 360 pixels is 180 degrees.
    expect(pose?.kind === "orbit" && pose.azimuthDeg).toBeCloseTo(218, 3);
    expect(viewer.canvas.dataset).toMatchObject({ ownView: "true", azimuth: "218.00" });
    expect(teacher.canvas.dataset).toMatchObject({ ownView: "false", azimuth: "200.00" });
    viewer.canvas.dragOver([
      [100, 100],
      [118, 100],
    ]);
    await pass(200);
    expect(saidOf("detach")).toHaveLength(1);
    expect(viewer.canvas.dataset.azimuth).toBe("227.00");
    viewer.page.follow();
    await pass(200);
    expect(viewer.canvas.dataset).toMatchObject({ ownView: "false", azimuth: "200.00" });
    expect(session().people.at(-1)?.shared.sent).toEqual([]);
  });

  it("turns the session's camera for who steers, and nobody looks around by that", async () => {
    const { teacher, viewer } = await classroom();
    teacher.canvas.dragOver([
      [100, 100],
      [136, 100],
    ]);
    await pass(400);
    expect(saidOf("detach", 0)).toEqual([]);
    expect(viewer.canvas.dataset).toMatchObject({ ownView: "false", azimuth: "218.00" });
  });

  it("does nothing but hint while following is locked, and brings back who looks around", async () => {
    const { teacher, viewer } = await classroom();
    viewer.page.move((pose) => pose);
    await pass(200);
    expect(viewer.page.state.session.lookingAround.value).toBe(true);
    teacher.page.actions.setRules({ followingLocked: true });
    await pass(200);
    expect(viewer.page.state.session.lookingAround.value).toBe(false);
    expect(viewer.canvas.dataset.ownView).toBe("false");
    viewer.page.move((pose) => pose);
    await pass(200);
    expect(saidOf("detach")).toHaveLength(1);
    expect(viewer.page.state.notices.value.map(({ text }) => text).join()).toMatch(/locked/);
  });

  it("asks for control, is given it, changes the scene and gives it back", async () => {
    const { teacher, viewer } = await classroom();
    viewer.page.actions.askControl();
    await pass(50);
    expect(teacher.page.state.session.asking.value).toHaveLength(1);
    const asking = teacher.page.state.session.asking.value[0];
    teacher.page.actions.giveControl(asking?.viewerId);
    await pass(50);
    expect(viewer.page.state.session.steering.value).toBe(true);
    expect(teacher.page.state.session.editBlock.value).toBe("Viewer 2 steers.");
    viewer.page.showTime(3);
    await pass(400);
    expect(teacher.page.state.timeIndex.value).toBe(3);
    // A viewer who steers another person's session does not change its picture size.
    expect(session().scene.output).toMatchObject({ widthPx: 640, heightPx: 360 });
    viewer.page.actions.giveControl();
    await pass(50);
    expect(viewer.page.state.session.editBlock.value).toBe("Presenter steers.");
    expect(teacher.page.state.session.steering.value).toBe(true);
    teacher.page.actions.giveControl();
    await pass(50);
    expect(teacher.page.state.session.editBlock.value).toBe("No one steers.");
    teacher.page.actions.takeControl();
    await pass(50);
    expect(teacher.page.state.session.steering.value).toBe(true);
  });

  it("keeps the picture and sends edits afterwards when the connection is lost", async () => {
    const { page, canvas } = await visit();
    network.down = true;
    network.break();
    await pass(100);
    expect(page.state.connection.value).toMatchObject({ kind: "lost" });
    expect(page.state.frame.value).toBeDefined();
    page.showTime(2);
    page.state.edit((scene) => withSky(scene, { turbidity: 3 }));
    await pass(3000);
    expect(session().revision).toBe(1n);
    network.down = false;
    await pass(10_000);
    expect(page.state.connection.value).toEqual({ kind: "live" });
    expect(session().scene).toMatchObject({ timeIndex: 2, sky: { turbidity: 3 } });
    expect(canvas.dataset.time).toBe("2");
    expect(service.sessions).toHaveLength(1);
  });

  it("keeps its edit when somebody else changed another part of the scene", async () => {
    const { page } = await visit();
    page.state.edit((scene) => withTime(scene, 1));
    session().changeScene(withSky(session().scene, { turbidity: 4 }));
    await pass(500);
    expect(session().scene).toMatchObject({ timeIndex: 1, sky: { turbidity: 4 } });
    expect(page.state.scene.value).toMatchObject({ timeIndex: 1, sky: { turbidity: 4 } });
  });

  it("says that the server has no storms, until it has one", async () => {
    service.empty = true;
    const { page } = await visit();
    const texts = () => page.state.notices.value.map(({ text }) => text);
    expect(texts()).toEqual(["the server has no storms"]);
    service.empty = false;
    await pass(30_000);
    expect(page.state.session.me.value).toBeDefined();
    expect(texts()).toEqual([]);
  });

  it("shows the server's scene again where an edit is refused", async () => {
    const { page } = await visit();
    page.state.edit((scene) => ({
      ...scene,
      display: { $typeName: "thunderhead.v1.Display", exposureEv: 50, toneMap: 0 },
    }));
    await pass(200);
    expect(page.state.notices.value[0]?.text).toBe("display.exposure_ev is 50");
    expect(page.state.scene.value.display?.exposureEv).toBeUndefined();
  });

  it("says when nobody sees it, gets no frames then, and the newest one afterwards", async () => {
    const { teacher, viewer } = await classroom();
    viewer.window.hide(true);
    await pass(20);
    expect(saidOf("window").at(-1)?.value).toMatchObject({ hidden: true, widthPx: 640 });
    const before = viewer.canvas.dataset.sequence;
    teacher.page.showTime(1);
    await pass(400);
    teacher.page.showTime(2);
    await pass(400);
    expect(viewer.canvas.dataset.sequence).toBe(before);
    expect(teacher.page.state.session.people.value.at(-1)?.hidden).toBe(true);
    viewer.window.hide(false);
    await pass(100);
    expect(viewer.canvas.dataset.revision).toBe(teacher.canvas.dataset.revision);
    expect(viewer.canvas.dataset.time).toBe("2");
  });

  it("repeats its window while it is looked at, so that a still picture keeps its session", async () => {
    const { window } = await visit();
    await pass(100_000);
    expect(saidOf("window")).toHaveLength(3);
    window.hide(true);
    await pass(100_000);
    expect(saidOf("window")).toHaveLength(4);
  });

  it("draws a line in the world that the viewer's page gets, and clears it", async () => {
    const { teacher, viewer } = await classroom();
    teacher.page.takeInHand("pen");
    teacher.canvas.dragOver([
      [100, 100],
      [150, 100],
      [200, 100],
      [200, 200],
    ]);
    expect(teacher.page.state.session.pendingMarks.value).toHaveLength(1);
    await pass(20);
    expect(teacher.page.state.session.pendingMarks.value).toEqual([]);
    const marks = viewer.page.state.session.marks.value;
    expect(marks).toMatchObject([{ viewerId: 1n }]);
    expect(marks[0]?.positions).toHaveLength(3);
    expect(teacher.canvas.dataset.azimuth).toBe("200.00");
    teacher.page.actions.eraseMarks();
    await pass(20);
    expect(viewer.page.state.session.marks.value).toEqual([]);
  });

  it("draws a line again that came while the one before was being placed", async () => {
    const { teacher, viewer } = await classroom();
    const { page, canvas } = teacher;
    page.takeInHand("pen");
    const line = (top: number) =>
      canvas.dragOver([
        [100, top],
        [200, top],
      ]);
    session().placing = 3;
    line(100);
    line(150);
    line(200);
    await pass(20);
    expect(page.state.session.pendingMarks.value).toHaveLength(3);
    session().placing = 1;
    await pass(1000);
    expect(viewer.page.state.session.marks.value).toHaveLength(3);
    expect(page.state.session.pendingMarks.value).toEqual([]);
    expect(page.state.notices.value).toEqual([]);
    expect(saidOf("addMark", 0)).toHaveLength(3 + 3 + 1);
  });

  it("says so in the end when a line is not taken", async () => {
    const { page, canvas } = await visit();
    page.takeInHand("pen");
    session().placing = 1000;
    canvas.dragOver([
      [100, 100],
      [200, 100],
    ]);
    await pass(6000);
    expect(page.state.session.pendingMarks.value).toEqual([]);
    expect(page.state.notices.value.map(({ text }) => text).join()).toMatch(/still being placed/);
    const sendings = saidOf("addMark").length;
    expect(sendings).toBeLessThan(30);
    await pass(6000);
    expect(saidOf("addMark")).toHaveLength(sendings);
  });

  it("points at most thirty times a second, the newest place last, and withdraws the pointer", async () => {
    const { teacher, viewer } = await classroom();
    teacher.page.takeInHand("pointer");
    for (let i = 0; i < 100; i += 1) {
      teacher.canvas.hover(200 + i, 180);
      await pass(10);
    }
    await pass(50);
    const points = saidOf("point", 0);
    expect(points.length).toBeGreaterThan(20);
    expect(points.length).toBeLessThanOrEqual(31);
    const [pointer] = viewer.page.state.session.pointers.value;
    expect(pointer?.viewerId).toBe(1n);
    teacher.canvas.tell("pointerleave");
    await pass(50);
    expect(viewer.page.state.session.pointers.value).toEqual([]);
  });

  it("leaves the tools to those who may draw", async () => {
    const { teacher, viewer } = await classroom();
    viewer.page.takeInHand("pen");
    expect(viewer.page.state.session.tool.value).toBe("pen");
    teacher.page.actions.setRules({ viewersMayMark: false });
    await pass(20);
    expect(viewer.page.state.session.tool.value).toBe("camera");
    viewer.page.takeInHand("pen");
    expect(viewer.page.state.session.tool.value).toBe("camera");
  });

  it("says that the session is not saved, until one is", async () => {
    service.diskFull = true;
    const { page } = await visit();
    const texts = () => page.state.notices.value.map(({ text }) => text);
    expect(texts()).toEqual([
      "This session is not saved: it ends with the server, unless the server can save it later.",
    ]);
    await pass(60_000);
    expect(texts()).toHaveLength(1);
    await page.actions.endSession();
    expect(texts()).toContain(`The session could not be ended: ${END_NOT_SAVED}`);
    service.diskFull = false;
    page.actions.openNewSession();
    await pass(500);
    expect(texts().join()).not.toContain("not saved: it ends");
  });

  it("says nothing of a session that is saved", async () => {
    const { page } = await visit();
    expect(page.state.notices.value).toEqual([]);
  });

  it("ends for everybody when the presenter says so, and opens a new one only by the button", async () => {
    const { teacher, viewer } = await classroom();
    await teacher.page.actions.endSession();
    await pass(20_000);
    for (const { page } of [teacher, viewer]) {
      expect(page.state.session.ended.value).toBe("The presenter has ended the session");
      expect(page.state.connection.value).toEqual({ kind: "gone" });
    }
    expect(service.sessions).toEqual([]);
    viewer.page.actions.openNewSession();
    await pass(500);
    expect(viewer.page.state.session.steering.value).toBe(true);
    expect(viewer.window.location.href).toContain(session().viewerKey);
    expect(service.sessions).toHaveLength(1);
  });

  it("replaces a session that the server lost: the presenter by itself, a viewer by the button", async () => {
    const { teacher, viewer } = await classroom();
    teacher.page.showTime(3);
    await pass(2000);
    const [address, storage] = [teacher.window.location.href, teacher.storage];
    leave(teacher);
    leave(viewer);
    service.forget(session());

    const stranger = await visit(address);
    expect(stranger.page.state.session.ended.value).toMatch(/no longer has this session/);
    expect(service.sessions).toEqual([]);
    stranger.page.actions.openNewSession();
    await pass(500);
    expect(session().scene.timeIndex).toBe(3);
    leave(stranger);
    service.forget(session());

    const again = await visit(address, storage);
    expect(again.page.state.session.steering.value).toBe(true);
    expect(session().scene.timeIndex).toBe(3);
    expect(again.window.location.href).toContain(session().viewerKey);
  });

  it("changes its name, and keeps it for the next time", async () => {
    const { viewer } = await classroom();
    viewer.page.actions.rename("  Ben ");
    await pass(100);
    expect(session().people.map(({ name }) => name)).toEqual(["", "Ben"]);
    const again = await reload(viewer);
    expect(again.page.state.session.people.value.at(-1)?.name).toBe("Ben");
  });

  it("looks around still when it joins again", async () => {
    const { viewer } = await classroom();
    viewer.canvas.dragOver([
      [100, 100],
      [136, 100],
    ]);
    await pass(200);
    network.break();
    await pass(3000);
    expect(viewer.canvas.dataset).toMatchObject({ ownView: "true", azimuth: "218.00" });
    const [joined] = session().people.filter(({ role }) => role === Role.VIEWER);
    expect(joined?.heard.filter(({ message }) => message.case === "detach")).toHaveLength(1);
  });

  it("gives an edit up that it may not make any more, and says so", async () => {
    const { teacher, viewer } = await classroom();
    teacher.page.actions.giveControl(2n);
    await pass(50);
    network.break();
    viewer.page.showTime(3);
    await pass(5000);
    expect(viewer.page.state.session.steering.value).toBe(false);
    expect(viewer.page.state.timeIndex.value).toBe(3);
    teacher.page.actions.takeControl();
    await pass(50);
    expect(viewer.page.state.timeIndex.value).toBe(0);
    expect(session().scene.timeIndex ?? 0).toBe(0);
    expect(notices(viewer)).toMatch(/not made/);
  });

  it("keeps a viewer's edit while the server still sees the lost connection steer", async () => {
    const { teacher, viewer } = await classroom();
    teacher.page.actions.giveControl(2n);
    await pass(50);
    session().noticesLosses = false;
    const lost = session().people.filter(({ role }) => role === Role.VIEWER);
    network.break();
    viewer.page.showTime(3);
    await pass(5000);
    const back = session()
      .people.filter(({ role }) => role === Role.VIEWER)
      .slice(1);
    expect([lost.length, back.length]).toEqual([1, 1]);
    expect(viewer.page.state.session.steering.value).toBe(false);
    expect(session().scene.timeIndex ?? 0).toBe(0);
    for (const person of lost) for (const other of back) session().replace(person, other);
    await pass(100);
    expect(viewer.page.state.session.steering.value).toBe(true);
    expect(session().scene.timeIndex).toBe(3);
    expect(notices(viewer)).not.toMatch(/not taken/);
  });

  // Joins a person who has the presenter's key but no page.
  const colleague = () => {
    const sessionKey = session().presenterKey;
    const message = { case: "join", value: { sessionKey } } as const;
    const person = session().join(
      create(InteractRequestSchema, { message }),
      () => undefined,
      () => undefined,
    );
    if (person === undefined) throw new Error("the colleague cannot join");
    return person;
  };

  // A teacher who steers loses the connection while an edit is unanswered, and reconnects after
  // `meanwhile`.
  const comesBack = async (teacher: Place, meanwhile: () => void) => {
    network.down = true;
    network.break();
    teacher.page.showTime(3);
    meanwhile();
    await pass(100);
    network.down = false;
    await pass(10_000);
  };

  it.each([
    ["the server still sees the lost connection steer", () => undefined],
    ["nobody steers", () => session().giveControl(0n)],
  ])("takes control again where %s", async (_, meanwhile) => {
    const teacher = await visit();
    session().noticesLosses = false;
    await comesBack(teacher, meanwhile);
    expect(saidOf("takeControl")).toHaveLength(1);
    expect(session().scene.timeIndex).toBe(3);
  });

  it("takes control again from a presenter who came first to a server that started again", async () => {
    const teacher = await visit();
    await comesBack(teacher, colleague);
    expect(saidOf("takeControl")).toHaveLength(1);
    expect(session().scene.timeIndex).toBe(3);
  });

  it("leaves control to a colleague who was there and took it", async () => {
    const teacher = await visit();
    const { viewerId } = colleague();
    await pass(50);
    await comesBack(teacher, () => session().giveControl(viewerId));
    expect(saidOf("takeControl")).toHaveLength(0);
    expect(teacher.page.state.session.steerer.value?.viewerId).toBe(viewerId);
    expect(teacher.page.state.timeIndex.value).toBe(0);
    expect(session().scene.timeIndex ?? 0).toBe(0);
  });
});
