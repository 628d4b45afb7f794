import { clone, create, fromJson, mergeFromJson, toJson } from "@bufbuild/protobuf";
import { SceneSync, type SceneVerdict } from "../../src/core/scene_sync";
import { type Scene, SceneSchema } from "../../src/gen/thunderhead/v1/scene_pb";
import type { Arguments, Observed, Runner } from "./case_files";

interface Sent {
  readonly scene: Scene;
  readonly expected: bigint;
  answer(verdict: SceneVerdict): void;
  lose(): void;
}

// The steps of a page whose time, screen and server the case controls.
class Page {
  scene = create(SceneSchema);
  discarded = 0;
  nowMs = 0;
  readonly sent: Sent[] = [];
  readonly paints = new Set<() => void>();
  readonly timers = new Set<{ readonly atMs: number; readonly callback: () => void }>();
  readonly sync = new SceneSync({
    scene: () => this.scene,
    adopt: (scene) => {
      this.scene = scene;
    },
    complete: (scene) => {
      this.scene = scene;
    },
    changedByOthers: () => undefined,
    send: (scene, expected) =>
      new Promise((answer, reject) => {
        this.sent.push({ scene, expected, answer, lose: () => reject(new Error("lost")) });
      }),
    taken: () => undefined,
    refused: () => undefined,
    onNextPaint: (callback) => {
      this.paints.add(callback);
      return () => this.paints.delete(callback);
    },
    later: (delayMs, callback) => {
      const timer = { atMs: this.nowMs + delayMs, callback };
      this.timers.add(timer);
      return () => this.timers.delete(timer);
    },
  });

  moveTo(nowMs: number): void {
    this.nowMs = nowMs;
    for (const timer of [...this.timers])
      if (timer.atMs <= nowMs && this.timers.delete(timer)) timer.callback();
  }

  refresh(): void {
    const due = [...this.paints];
    this.paints.clear();
    for (const callback of due) callback();
  }

  observed(): Observed {
    return {
      scene: toJson(SceneSchema, this.scene),
      settled: !this.sync.unsettled,
      revision: Number(this.sync.revision),
      discarded: this.discarded,
    };
  }
}

// Waits until the responses were handled.
const settle = () => new Promise<void>((resolve) => setTimeout(resolve, 0));

export const runSceneSync: Runner = () => {
  const page = new Page();
  const { sync } = page;
  const act = (action: (step: Arguments) => void) => async (step: Arguments) => {
    action(step);
    await settle();
    return page.observed();
  };
  const sentOne = (step: Arguments): Sent => {
    const sent = page.sent[step.number("sent")];
    if (sent === undefined) throw new Error("no such scene was sent");
    return sent;
  };
  return {
    told: act((step) => {
      const scene = fromJson(SceneSchema, step.json("scene"));
      sync.told(scene, BigInt(step.number("revision")));
    }),
    edit: act((step) => {
      const change = step.json("scene");
      const edit = (scene: Scene) => mergeFromJson(SceneSchema, clone(SceneSchema, scene), change);
      page.scene = edit(page.scene);
      sync.edited(edit);
    }),
    refresh: async (step) => {
      page.moveTo(step.number("at_ms", page.nowMs));
      const before = page.sent.length;
      page.refresh();
      await settle();
      const sends = page.sent.slice(before).map(({ scene, expected }) => ({
        scene: toJson(SceneSchema, scene),
        expected_revision: Number(expected),
      }));
      return { ...page.observed(), sends };
    },
    taken: act((step) => {
      sentOne(step).answer({ kind: "taken", revision: BigInt(step.number("revision")) });
    }),
    refused: act((step) => {
      const reason = step.text("reason");
      if (reason === "stale") sentOne(step).answer({ kind: "stale" });
      else if (reason === "busy" || reason === "refused")
        sentOne(step).answer({ kind: reason, message: "" });
      else throw new Error(`the runner does not know the reason '${reason}'`);
    }),
    steer: act(() => sync.allow()),
    hold: act(() => sync.hold()),
    another_steers: act(() => {
      sync.hold();
      sync.discard(() => {
        page.discarded += 1;
      });
    }),
    lose: act(() => {
      for (const sent of page.sent) sent.lose();
      sync.hold();
    }),
    rejoin: act(() => sync.forget()),
  };
};
