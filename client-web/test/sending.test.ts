import { create } from "@bufbuild/protobuf";
import { describe, expect, it, vi } from "vitest";
import { BackOff } from "../src/core/back_off";
import { cameraOfPose, homeCamera, zoom } from "../src/core/camera";
import { Newest } from "../src/core/newest";
import { Playback } from "../src/core/playback";
import { withCamera, withSky, withTime } from "../src/core/scene";
import { type Edit, SceneSync, type SceneVerdict } from "../src/core/scene_sync";
import { PageState } from "../src/core/state";
import { type Scene, SceneSchema } from "../src/gen/thunderhead/v1/scene_pb";

const sceneOf = (timeIndex: number): Scene => create(SceneSchema, { timeIndex });

// Makes a server whose answers and scenes the test controls.
function bench(first: Scene = sceneOf(0)) {
  const sent: {
    scene: Scene;
    expected: bigint;
    answer(verdict: SceneVerdict): void;
    lost(): void;
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
      new Promise((answer, reject) => {
        sent.push({ scene, expected, answer, lost: () => reject(new Error("lost")) });
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
    times: () => sent.map(({ scene }) => scene.timeIndex),
  };
}

const taken = (revision: bigint): SceneVerdict => ({ kind: "taken", revision });

describe("scenes on their way to the server", () => {
  // Makes a page that steers and knows revision 1.
  function steering() {
    const b = bench();
    b.sync.told(sceneOf(0), 1n);
    b.sync.allow();
    return b;
  }

  it("leave once a screen refresh, the newest alone, with the revision they were made from", async () => {
    const b = steering();
    for (const time of [1, 2, 3]) b.toTime(time);
    expect(b.times()).toEqual([]);
    await b.refresh();
    expect(b.times()).toEqual([3]);
    expect(b.sent[0]?.expected).toBe(1n);
  });

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

  const expectations = (b: ReturnType<typeof bench>) => b.sent.map(({ expected }) => expected);

  it("follow each other from the revision that the one before becomes, four at most", async () => {
    const b = steering();
    for (const time of [1, 2, 3, 4, 5, 6]) {
      b.toTime(time);
      await b.refresh();
    }
    expect(b.times()).toEqual([1, 2, 3, 4]);
    expect(expectations(b)).toEqual([1n, 2n, 3n, 4n]);
    expect(b.sync.unsettled).toBe(true);
    b.sent[0]?.answer(taken(2n));
    await b.settle();
    await b.refresh();
    expect(b.times()).toEqual([1, 2, 3, 4, 6]);
    expect(b.sent[4]?.expected).toBe(5n);
    for (const [i, one] of b.sent.entries()) one.answer(taken(BigInt(i + 2)));
    await b.settle();
    await b.refresh();
    expect(b.sent).toHaveLength(5);
    expect(b.sync.unsettled).toBe(false);
    expect(b.sync.revision).toBe(6n);
  });

  it("go one at a time until the session's revision is known", async () => {
    const b = bench();
    b.sync.allow();
    b.toTime(1);
    await b.refresh();
    b.toTime(2);
    await b.refresh();
    expect(b.times()).toEqual([1]);
    b.sent[0]?.answer(taken(7n));
    await b.settle();
    await b.refresh();
    expect(expectations(b)).toEqual([-1n, 7n]);
  });

  it("of which one is stale wait for the others' answers, and for the newer scene alone", async () => {
    const b = steering();
    for (const time of [1, 2, 3]) {
      b.toTime(time);
      await b.refresh();
    }
    b.sent[0]?.answer({ kind: "stale" });
    await b.settle();
    b.sync.told(withSky(sceneOf(0), { turbidity: 3 }), 5n);
    await b.refresh();
    expect(b.sent).toHaveLength(3);
    b.sent[1]?.answer({ kind: "stale" });
    b.sent[2]?.answer({ kind: "stale" });
    await b.settle();
    await b.refresh();
    expect(b.sent).toHaveLength(4);
    expect(b.sent[3]).toMatchObject({
      expected: 5n,
      scene: { timeIndex: 3, sky: { turbidity: 3 } },
    });
    b.sent[3]?.answer(taken(6n));
    await b.settle();
    expect(b.sync.unsettled).toBe(false);
  });

  it("of which one is refused keep the edits after it, which go again at once", async () => {
    const b = steering();
    for (const time of [99, 2]) {
      b.toTime(time);
      await b.refresh();
    }
    b.sent[0]?.answer({ kind: "refused", message: "no such time" });
    b.sent[1]?.answer({ kind: "stale" });
    await b.settle();
    await b.refresh();
    expect(b.page.refused).toEqual(["no such time"]);
    expect(b.times()).toEqual([99, 2, 2]);
    expect(b.sent[2]?.expected).toBe(1n);
  });

  it("all lost go again as one", async () => {
    const b = steering();
    for (const time of [1, 2]) {
      b.toTime(time);
      await b.refresh();
    }
    for (const one of b.sent) one.lost();
    await b.settle();
    b.sync.told(sceneOf(0), 1n);
    b.sync.allow();
    await b.refresh();
    expect(b.times()).toEqual([1, 2, 2]);
    expect(b.sent[2]?.expected).toBe(1n);
  });

  it("are sent again after a loss, once the session is joined again", async () => {
    const b = steering();
    b.toTime(1);
    await b.refresh();
    b.sent[0]?.lost();
    await b.settle();
    b.toTime(2);
    await b.refresh();
    expect(b.times()).toEqual([1]);
    b.sync.forget();
    b.sync.told(sceneOf(0), 1n);
    b.sync.allow();
    await b.refresh();
    expect(b.times()).toEqual([1, 2]);
    expect(b.page.scene.timeIndex).toBe(2);
  });

  it("keep the edit under the hand when somebody else changed the scene first", async () => {
    const b = steering();
    b.toTime(2);
    await b.refresh();
    b.sent[0]?.answer({ kind: "stale" });
    await b.settle();
    await b.refresh();
    // Nothing is sent before the newer scene is known.
    expect(b.sent).toHaveLength(1);
    b.sync.told(withSky(sceneOf(0), { turbidity: 3 }), 5n);
    await b.refresh();
    expect(b.sent[1]).toMatchObject({
      expected: 5n,
      scene: { timeIndex: 2, sky: { turbidity: 3 } },
    });
    expect(b.page.scene.sky?.turbidity).toBe(3);
    expect(b.page.others).toEqual([1n, 5n]);
  });

  it("adopt another's scene at once while nothing is edited, or after the answer", async () => {
    const b = steering();
    b.sync.told(sceneOf(3), 2n);
    expect(b.page.scene.timeIndex).toBe(3);
    b.toTime(1);
    await b.refresh();
    b.sync.told(withSky(sceneOf(1), { turbidity: 4 }), 4n);
    expect(b.page.scene.sky).toBeUndefined();
    b.sent[0]?.answer(taken(3n));
    await b.settle();
    expect(b.page.scene.sky?.turbidity).toBe(4);
  });

  it("are completed by the server's version of the same revision", async () => {
    const b = steering();
    b.toTime(1);
    await b.refresh();
    b.sync.told(sceneOf(1), 2n);
    expect(b.page.completed).toBe(0);
    b.sent[0]?.answer(taken(2n));
    await b.settle();
    expect(b.page.completed).toBe(1);
    expect(b.page.others).toEqual([1n]);
  });

  it("go back to the server's where they are refused", async () => {
    const b = steering();
    b.toTime(9);
    await b.refresh();
    b.sent[0]?.answer({ kind: "refused", message: "time_index is 9" });
    await b.settle();
    expect(b.page.refused).toEqual(["time_index is 9"]);
    expect(b.page.scene.timeIndex).toBe(0);
    expect(b.sync.unsettled).toBe(false);
  });

  it("go back to the last that was taken where they are refused before the server tells of it", async () => {
    const b = bench();
    b.sync.told(sceneOf(0), 1n);
    b.sync.allow();
    b.toTime(1);
    await b.refresh();
    b.sent[0]?.answer({ kind: "taken", revision: 2n });
    await b.settle();
    b.toTime(99);
    await b.refresh();
    b.sent[1]?.answer({ kind: "refused", message: "no such time" });
    await b.settle();
    expect(b.page.scene.timeIndex).toBe(1);
    b.sync.told(sceneOf(1), 2n);
    b.toTime(2);
    await b.refresh();
    expect(b.times()).toEqual([1, 99, 2]);
  });

  it("are tried again where they were stale and nothing newer came", async () => {
    const b = bench();
    b.sync.told(sceneOf(0), 1n);
    b.sync.allow();
    b.toTime(1);
    await b.refresh();
    b.sent[0]?.answer({ kind: "stale" });
    await b.settle();
    await b.refresh();
    expect(b.times()).toEqual([1]);
    b.rest();
    await b.refresh();
    expect(b.times()).toEqual([1, 1]);
  });

  it("are tried again after a rest where the server is busy", async () => {
    const b = steering();
    b.toTime(1);
    await b.refresh();
    b.sent[0]?.answer({ kind: "busy", message: "too much to draw" });
    await b.settle();
    await b.refresh();
    expect(b.sent).toHaveLength(1);
    b.rest();
    await b.refresh();
    expect(b.times()).toEqual([1, 1]);
  });

  it("stay while another steers, and are given up on request", async () => {
    const b = steering();
    b.sync.hold();
    b.toTime(2);
    await b.refresh();
    expect(b.sent).toEqual([]);
    const lost = vi.fn();
    b.sync.discard(lost);
    expect(b.page.scene.timeIndex).toBe(0);
    expect(b.sync.unsettled).toBe(false);
    expect(lost).toHaveBeenCalledTimes(1);
  });

  it("that were taken before another steered stay, and are not said to be lost", async () => {
    const b = steering();
    b.toTime(2);
    await b.refresh();
    b.sync.hold();
    const lost = vi.fn();
    b.sync.discard(lost);
    expect(b.page.scene.timeIndex).toBe(2);
    b.sent[0]?.answer(taken(2n));
    await b.settle();
    b.sync.told(sceneOf(2), 2n);
    await b.settle();
    expect(b.page.scene.timeIndex).toBe(2);
    expect(b.sync.unsettled).toBe(false);
    expect(lost).not.toHaveBeenCalled();
  });

  it("that come too late as another steers are given up, with a word, for the scene that is there", async () => {
    const b = steering();
    b.toTime(2);
    await b.refresh();
    b.toTime(3);
    b.sync.hold();
    const lost = vi.fn();
    b.sync.discard(lost);
    b.sent[0]?.answer({ kind: "stale" });
    await b.settle();
    b.sync.told(sceneOf(1), 2n);
    await b.refresh();
    expect(b.page.scene.timeIndex).toBe(1);
    expect(b.sent).toHaveLength(1);
    expect(lost).toHaveBeenCalledTimes(1);
  });

  it("made while another steers are given up at once, with a word, until this page steers", async () => {
    const b = steering();
    b.sync.told(sceneOf(1), 2n);
    b.sync.hold();
    const lost = vi.fn();
    b.sync.discard(lost);
    expect(lost).not.toHaveBeenCalled();
    b.toTime(3);
    expect(b.page.scene.timeIndex).toBe(1);
    expect(lost).toHaveBeenCalledTimes(1);
    b.toTime(4);
    expect(b.page.scene.timeIndex).toBe(1);
    expect(lost).toHaveBeenCalledTimes(2);
    b.sync.allow();
    b.toTime(3);
    await b.refresh();
    expect(b.page.scene.timeIndex).toBe(3);
    expect(b.sent).toHaveLength(1);
  });

  it("go on where this page steers again before the answer", async () => {
    const b = steering();
    b.toTime(2);
    await b.refresh();
    b.sync.hold();
    const lost = vi.fn();
    b.sync.discard(lost);
    b.sync.allow();
    b.sent[0]?.answer({ kind: "stale" });
    await b.settle();
    b.sync.told(sceneOf(1), 2n);
    await b.refresh();
    expect(b.page.scene.timeIndex).toBe(2);
    expect(b.sent[1]?.expected).toBe(2n);
    expect(lost).not.toHaveBeenCalled();
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
  it("doubles its bound to eight seconds, and begins anew after a success", () => {
    const backOff = new BackOff(() => 1);
    expect(Array.from({ length: 7 }, () => backOff.next())).toEqual([
      1000, 2000, 4000, 8000, 8000, 8000, 8000,
    ]);
    backOff.reset();
    expect(backOff.next()).toBe(1000);
  });

  it("draws a delay anywhere below the bound, and never before the server's own", () => {
    expect(new BackOff(() => 0.25).next()).toBe(250);
    expect(new BackOff(() => 0.5).next(3000)).toBe(3500);
  });

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
    state.onEdit((edit) => edits.push(edit(sceneOf(7)).timeIndex ?? 0));
    state.adoptScene(sceneOf(1));
    state.edit((scene) => withTime(scene, 2));
    state.edit((scene) => scene);
    expect(edits).toEqual([2]);
    expect(state.timeIndex.value).toBe(2);
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
