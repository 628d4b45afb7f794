import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { BackOff } from "../src/core/back_off";
import { cameraOfPose, homeCamera, zoom } from "../src/core/camera";
import { Playback } from "../src/core/playback";
import { withCamera, withTime } from "../src/core/scene";
import { SceneSender } from "../src/core/scene_sender";
import { PageState } from "../src/core/state";
import { type Scene, SceneSchema } from "../src/gen/thunderhead/v1/scene_pb";

const sceneOf = (timeIndex: number): Scene => create(SceneSchema, { timeIndex });

function bench() {
  const sent: { scene: Scene; taken(): void; lost(): void }[] = [];
  const paints: (() => void)[] = [];
  const sender = new SceneSender({
    send: (scene) =>
      new Promise((resolve, reject) => {
        sent.push({ scene, taken: resolve, lost: () => reject(new Error("lost")) });
      }),
    onNextPaint: (callback) => {
      paints.push(callback);
      return () => paints.splice(paints.indexOf(callback), 1);
    },
  });
  const settle = () => new Promise<void>((resolve) => setTimeout(resolve, 0));
  const refresh = async () => {
    for (const paint of paints.splice(0)) paint();
    await settle();
  };
  return { sender, sent, refresh, settle, times: () => sent.map(({ scene }) => scene.timeIndex) };
}

describe("scenes on their way to the server", () => {
  it("leave once a screen refresh, the newest alone", async () => {
    const b = bench();
    b.sender.start();
    for (const time of [1, 2, 3]) b.sender.push(sceneOf(time));
    expect(b.times()).toEqual([]);
    await b.refresh();
    expect(b.times()).toEqual([3]);
  });

  it("wait while one is in flight, and then only the newest goes", async () => {
    const b = bench();
    b.sender.start();
    b.sender.push(sceneOf(1));
    await b.refresh();
    b.sender.push(sceneOf(2));
    await b.refresh();
    b.sender.push(sceneOf(3));
    await b.refresh();
    expect(b.times()).toEqual([1]);
    expect(b.sender.unsettled).toBe(true);
    b.sent[0]?.taken();
    await b.settle();
    await b.refresh();
    expect(b.times()).toEqual([1, 3]);
    b.sent[1]?.taken();
    await b.settle();
    expect(b.sender.unsettled).toBe(false);
  });

  it("are sent again after a loss, but never older after newer", async () => {
    const b = bench();
    b.sender.start();
    b.sender.push(sceneOf(1));
    await b.refresh();
    b.sent[0]?.lost();
    await b.settle();
    await b.refresh();
    expect(b.times()).toEqual([1]);
    b.sender.start();
    await b.refresh();
    expect(b.times()).toEqual([1, 1]);
    b.sender.push(sceneOf(2));
    b.sent[1]?.lost();
    await b.settle();
    b.sender.start();
    await b.refresh();
    expect(b.times()).toEqual([1, 1, 2]);
  });

  it("are not repeated to a session that began with them", async () => {
    const b = bench();
    b.sender.start();
    b.sender.push(sceneOf(1));
    await b.refresh();
    b.sender.stop();
    const newest = sceneOf(2);
    b.sender.push(newest);
    b.sender.start(newest);
    // Only now does the old scene fail.
    b.sent[0]?.lost();
    await b.settle();
    await b.refresh();
    expect(b.times()).toEqual([1]);
    expect(b.sender.unsettled).toBe(false);
  });

  it("made before there is a session wait for it", async () => {
    const b = bench();
    b.sender.push(sceneOf(4));
    await b.refresh();
    expect(b.times()).toEqual([]);
    b.sender.start(sceneOf(0));
    await b.refresh();
    expect(b.times()).toEqual([4]);
  });
});

describe("back-off", () => {
  it("doubles from a quarter of a second to four, and begins anew after a success", () => {
    const backOff = new BackOff();
    expect(Array.from({ length: 7 }, () => backOff.next())).toEqual([
      250, 500, 1000, 2000, 4000, 4000, 4000,
    ]);
    backOff.reset();
    expect(backOff.next()).toBe(250);
  });
});

describe("play", () => {
  function startPlayer(count: number) {
    const paints: ((nowMs: number) => void)[] = [];
    const player = { index: 0, shown: 0, history: [] as number[] };
    const playback = new Playback({
      timeCount: () => count,
      timeIndex: () => player.index,
      isShown: (index) => player.shown === index,
      showTime: (index) => {
        player.index = index;
        player.history.push(index);
      },
      onNextPaint: (callback) => {
        paints.push(callback);
        return () => paints.splice(paints.indexOf(callback), 1);
      },
    });
    const at = (nowMs: number) => {
      for (const paint of paints.splice(0)) paint(nowMs);
    };
    return { player, playback, at };
  }

  it("goes on at its rate, and round", () => {
    const { player, playback, at } = startPlayer(3);
    playback.timesPerSecond.value = 2;
    playback.play();
    for (let now = 0; now <= 2000; now += 100) {
      at(now);
      player.shown = player.index;
    }
    expect(player.history).toEqual([1, 2, 0, 1, 2]);
  });

  it("waits for the picture of a time, however long it takes", () => {
    const { player, playback, at } = startPlayer(3);
    playback.play();
    at(0);
    for (let now = 100; now < 5000; now += 100) at(now);
    expect(player.history).toEqual([1]);
    player.shown = 1;
    at(5000);
    expect(player.history).toEqual([1, 2]);
  });

  it("does nothing with a single time, and stops when told", () => {
    const single = startPlayer(1);
    single.playback.play();
    expect(single.playback.playing.value).toBe(false);
    const { player, playback, at } = startPlayer(3);
    playback.play();
    playback.pause();
    at(0);
    expect(player.history).toEqual([]);
  });
});

describe("the page's state", () => {
  const pose = {
    kind: "orbit" as const,
    targetM: [0, 0, 5000] as const,
    azimuthDeg: 200,
    elevationDeg: 8,
    distanceM: 50_000,
    fieldOfViewDeg: 35,
  };

  it("tells edits, but not what the server said", () => {
    const state = new PageState();
    const edits: number[] = [];
    state.onEdit((scene) => edits.push(scene.timeIndex ?? 0));
    state.adoptScene(sceneOf(1));
    state.edit((scene) => withTime(scene, 2));
    state.edit((scene) => scene);
    expect(edits).toEqual([2]);
    expect(state.timeIndex.value).toBe(2);
  });

  it("takes the camera from a frame where the scene leaves it open, or somebody else moved it", () => {
    const state = new PageState();
    state.move((p) => zoom(p, 0.5));
    expect(state.scene.value.camera).toBeUndefined();
    state.adoptCamera(cameraOfPose(pose), false);
    expect(state.pose.value).toEqual(pose);
    state.move((p) => zoom(p, 0.5));
    state.adoptCamera(cameraOfPose(pose), false);
    expect(state.pose.value).toEqual(zoom(pose, 0.5));
    state.adoptCamera(cameraOfPose(pose), true);
    expect(state.pose.value).toEqual(pose);
  });

  it("knows no pose of another kind of camera until the server has placed it", () => {
    const state = new PageState();
    state.adoptCamera(cameraOfPose(pose), false);
    state.edit((scene) => withCamera(scene, homeCamera("spotter")));
    expect(state.cameraKind.value).toBe("spotter");
    expect(state.pose.value).toBeUndefined();
    const spotter = {
      kind: "spotter" as const,
      placeM: [1000, -60_000] as const,
      eyeHeightM: 2,
      azimuthDeg: 20,
      elevationDeg: 6,
      focalLengthMm: 24,
    };
    state.adoptCamera(cameraOfPose(spotter), false);
    expect(state.pose.value).toEqual(spotter);
  });

  it("keeps one notice a subject", () => {
    const state = new PageState();
    state.notify({ subject: "problem", text: "first", severity: "problem" });
    state.notify({ subject: "link", text: "copied", severity: "note" });
    state.notify({ subject: "problem", text: "second", severity: "problem" });
    expect(state.notices.value.map(({ text }) => text)).toEqual(["copied", "second"]);
    state.dismiss("problem");
    expect(state.notices.value.map(({ text }) => text)).toEqual(["copied"]);
  });
});
