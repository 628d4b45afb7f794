import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { BackOff } from "../src/core/back_off";
import { cameraOfPose, homeCamera, zoom } from "../src/core/camera";
import { Newest } from "../src/core/newest";
import { withCamera, withSky, withTime } from "../src/core/scene";
import { type Edit, SceneSync, type SceneVerdict } from "../src/core/scene_sync";
import { PageState } from "../src/core/state";
import { type Scene, SceneSchema } from "../src/gen/thunderhead/v1/scene_pb";
import { StormDescriptionSchema, StormSummarySchema } from "../src/gen/thunderhead/v1/storm_pb";

const sceneOf = (timeIndex: number): Scene => create(SceneSchema, { timeIndex });

// Makes a server whose answers and scenes the test controls.
function bench(first: Scene = sceneOf(0)) {
  const sent: {
    scene: Scene;
    expected: bigint;
    answer(verdict: SceneVerdict): void;
  }[] = [];
  const paints: (() => void)[] = [];
  const rests: (() => void)[] = [];
  const page = { scene: first, refused: [] as string[], others: [] as bigint[], completed: 0 };
  const agreed: (bigint | undefined)[] = [];
  const sync = new SceneSync({
    scene: () => page.scene,
    adopt: (scene) => {
      page.scene = scene;
    },
    complete: () => {
      page.completed += 1;
    },
    changedByOthers: (_, revision) => page.others.push(revision),
    send: (scene, expected) =>
      new Promise((answer) => {
        sent.push({ scene, expected, answer });
      }),
    taken: () => undefined,
    agreed: (revision) => agreed.push(revision),
    refused: (message) => page.refused.push(message),
    onNextPaint: (callback) => {
      paints.push(callback);
      return () => paints.splice(paints.indexOf(callback), 1);
    },
    later: (_, callback) => {
      rests.push(callback);
      return () => undefined;
    },
  });
  const settle = () => new Promise<void>((resolve) => setTimeout(resolve, 0));
  const refresh = async () => {
    for (const paint of paints.splice(0)) paint();
    await settle();
  };
  const edit = (change: Edit) => {
    page.scene = change(page.scene);
    sync.edited(change);
  };
  return {
    sync,
    sent,
    page,
    agreed,
    refresh,
    settle,
    edit,
    rest: () => {
      for (const callback of rests.splice(0)) callback();
    },
    toTime: (time: number) => edit((scene) => withTime(scene, time)),
  };
}

const taken = (revision: bigint): SceneVerdict => ({ kind: "taken", revision });

// The shared cases (tests/clients/cases/scene_sync.json) test which scenes are sent and adopted. These
// tests are of what only the page does.
describe("scenes on their way to the server", () => {
  // Makes a page that steers and knows revision 1.
  function steering() {
    const b = bench();
    b.sync.told(sceneOf(0), 1n);
    b.sync.allow();
    return b;
  }

  it("are agreed on once the server has taken them and told what they became", async () => {
    const b = steering();
    expect(b.agreed).toEqual([1n]);
    b.toTime(1);
    expect(b.sync.agreed).toBeUndefined();
    await b.refresh();
    b.sent[0]?.answer(taken(2n));
    await b.settle();
    expect(b.sync.agreed).toBeUndefined();
    b.sync.told(sceneOf(1), 2n);
    expect(b.sync.agreed).toBe(2n);
    b.sync.forget();
    expect(b.sync.agreed).toBeUndefined();
    expect(b.agreed).toEqual([1n, undefined, undefined, 2n, undefined]);
  });

  it("are refused with the server's message, which the page shows", async () => {
    const b = steering();
    b.toTime(9);
    await b.refresh();
    b.sent[0]?.answer({ kind: "busy", message: "too much to draw" });
    await b.settle();
    b.rest();
    await b.refresh();
    b.sent[1]?.answer({ kind: "refused", message: "time_index is 9" });
    await b.settle();
    expect(b.page.refused).toEqual(["too much to draw", "time_index is 9"]);
  });

  it("are told from those of other people, and completed by the server's version", async () => {
    const b = steering();
    expect(b.page.others).toEqual([1n]);
    b.toTime(1);
    await b.refresh();
    b.sync.told(sceneOf(1), 2n);
    expect(b.page.completed).toBe(0);
    b.sent[0]?.answer(taken(2n));
    await b.settle();
    expect([b.page.completed, b.page.others]).toEqual([1, [1n]]);
    b.sync.told(sceneOf(3), 3n);
    expect([b.page.completed, b.page.others]).toEqual([1, [1n, 3n]]);
  });

  it("made while a session is opened follow its opening scene", async () => {
    const b = bench();
    b.toTime(1);
    b.sync.opening();
    b.edit((scene) => withSky(scene, { turbidity: 2 }));
    b.sync.opened(create(SceneSchema, { timeIndex: 1, stormId: "supercell" }), 1n);
    b.sync.allow();
    await b.refresh();
    expect(b.sent).toMatchObject([
      { expected: 1n, scene: { timeIndex: 1, stormId: "supercell", sky: { turbidity: 2 } } },
    ]);
  });
});

describe("the newest of many values", () => {
  it("goes at once, then once an interval, and the last one always", () => {
    const sent: number[] = [];
    const timers: (() => void)[] = [];
    const newest = new Newest<number>(
      30,
      (_, callback) => {
        timers.push(callback);
        return () => undefined;
      },
      (value) => sent.push(value),
    );
    const tick = () => timers.shift()?.();
    for (const value of [1, 2, 3]) newest.offer(value);
    expect(sent).toEqual([1]);
    tick();
    expect(sent).toEqual([1, 3]);
    tick();
    tick();
    newest.offer(4);
    expect(sent).toEqual([1, 3, 4]);
    newest.offer(5);
    newest.clear();
    tick();
    expect(sent).toEqual([1, 3, 4]);
  });
});

describe("back-off", () => {
  it("spreads a class over a second, also after a delay that is the same for all", () => {
    for (const leastMs of [0, 3000]) {
      const delays = Array.from({ length: 500 }, () => new BackOff().next(leastMs) - leastMs);
      // 500 random delays include some below 50 ms and some above 950 ms. This fails only once in
      // 10^10 runs.
      expect(Math.min(...delays)).toBeLessThan(50);
      expect(Math.max(...delays)).toBeGreaterThan(950);
    }
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
    state.onEdit((edit) => edits.push(edit(sceneOf(7)).timeIndex ?? 0));
    state.adoptScene(sceneOf(1));
    state.edit((scene) => withTime(scene, 2));
    state.edit((scene) => scene);
    expect(edits).toEqual([2]);
    expect(state.timeIndex.value).toBe(2);
  });

  it("shows the storm's last time where the scene names none, as the server does", () => {
    const state = new PageState();
    state.adoptScene(create(SceneSchema, { stormId: "moore" }));
    expect(state.timeIndex.value).toBe(0);
    state.storms.value = [create(StormSummarySchema, { id: "moore", timeCount: 6 })];
    expect(state.timeIndex.value).toBe(5);
    const times = Array.from({ length: 8 }, () => ({}));
    state.storm.value = create(StormDescriptionSchema, { id: "moore", times });
    expect(state.timeIndex.value).toBe(7);
    state.edit((scene) => withTime(scene, 0));
    expect(state.timeIndex.value).toBe(0);
  });

  it("takes the camera from a frame where the scene leaves it open, and only there", () => {
    const state = new PageState();
    state.move((p) => zoom(p, 0.5));
    expect(state.scene.value.camera).toBeUndefined();
    state.adoptCamera(cameraOfPose(pose));
    expect(state.pose.value).toEqual(pose);
    state.move((p) => zoom(p, 0.5));
    state.adoptCamera(cameraOfPose(pose));
    expect(state.pose.value).toEqual(zoom(pose, 0.5));
  });

  it("knows no pose of another kind of camera until the server has placed it", () => {
    const state = new PageState();
    state.adoptCamera(cameraOfPose(pose));
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
    state.adoptCamera(cameraOfPose(spotter));
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
