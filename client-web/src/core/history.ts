// Undo and redo of changes made on this page. Undoing a step restores only the values that the step
// changed, because other viewers may have changed the rest of the scene meanwhile. Edits that
// closely follow each other, such as those of a slider or a drag, are one step.
import { computed, type Signal, signal } from "@preact/signals-core";
import { type Scene, SceneSchema } from "../gen/thunderhead/v1/scene_pb";
import { type Change, changeBetween, withChange } from "./scene_change";

const ONE_GESTURE_MS = 700;
const MAX_STEPS = 100;

// The edits of one gesture, the oldest first.
type Step = readonly Change[];

export class History {
  readonly #past = signal<readonly Step[]>([]);
  readonly #future = signal<readonly Step[]>([]);
  readonly #nowMs: () => number;
  #lastEditMs = Number.NEGATIVE_INFINITY;

  readonly canUndo = computed(() => this.#past.value.length > 0);
  readonly canRedo = computed(() => this.#future.value.length > 0);

  constructor(nowMs: () => number) {
    this.#nowMs = nowMs;
  }

  // Records an edit of the scene.
  edited(before: Scene, after: Scene): void {
    const change = changeBetween(SceneSchema, before, after);
    if (change === undefined) return;
    const now = this.#nowMs();
    const sameGesture = now - this.#lastEditMs < ONE_GESTURE_MS;
    this.#lastEditMs = now;
    this.#future.value = [];
    const past = this.#past.value;
    const last = sameGesture ? past.at(-1) : undefined;
    this.#past.value =
      last === undefined
        ? [...past, [change]].slice(-MAX_STEPS)
        : [...past.slice(0, -1), [...last, change]];
  }

  // Returns the edit that undoes the last step; undefined if no step can be undone.
  undo(): ((scene: Scene) => Scene) | undefined {
    const step = this.#move(this.#past, this.#future);
    return (
      step &&
      ((scene) => step.reduceRight((undone, change) => withChange(undone, change, "before"), scene))
    );
  }

  redo(): ((scene: Scene) => Scene) | undefined {
    const step = this.#move(this.#future, this.#past);
    return (
      step && ((scene) => step.reduce((done, change) => withChange(done, change, "after"), scene))
    );
  }

  // Forgets all steps. This is needed when another storm is shown.
  clear(): void {
    this.#past.value = [];
    this.#future.value = [];
    this.#lastEditMs = Number.NEGATIVE_INFINITY;
  }

  #move(from: Signal<readonly Step[]>, to: Signal<readonly Step[]>): Step | undefined {
    const step = from.value.at(-1);
    if (step === undefined) return undefined;
    from.value = from.value.slice(0, -1);
    to.value = [...to.value, step];
    this.#lastEditMs = Number.NEGATIVE_INFINITY;
    return step;
  }
}
