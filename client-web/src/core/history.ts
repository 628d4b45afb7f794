// Changes made on this page, to be undone and done again. Edits that follow each other closely, as of a slider or a drag, count as one.
import { computed, type Signal, signal } from "@preact/signals-core";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";

const ONE_GESTURE_MS = 700;
const MOST_STEPS = 100;

export class History {
  readonly #past = signal<readonly Scene[]>([]);
  readonly #future = signal<readonly Scene[]>([]);
  readonly #nowMs: () => number;
  #lastEditMs = Number.NEGATIVE_INFINITY;

  readonly canUndo = computed(() => this.#past.value.length > 0);
  readonly canRedo = computed(() => this.#future.value.length > 0);

  constructor(nowMs: () => number) {
    this.#nowMs = nowMs;
  }

  // The scene was edited; `before` is what it was.
  edited(before: Scene): void {
    const now = this.#nowMs();
    const sameGesture = now - this.#lastEditMs < ONE_GESTURE_MS;
    this.#lastEditMs = now;
    this.#future.value = [];
    if (!sameGesture) this.#past.value = [...this.#past.value, before].slice(-MOST_STEPS);
  }

  // The scene before the last change, in place of `present`; undefined if there is none.
  undo(present: Scene): Scene | undefined {
    return this.#step(this.#past, this.#future, present);
  }

  redo(present: Scene): Scene | undefined {
    return this.#step(this.#future, this.#past, present);
  }

  #step(
    from: Signal<readonly Scene[]>,
    to: Signal<readonly Scene[]>,
    present: Scene,
  ): Scene | undefined {
    const scene = from.value.at(-1);
    if (scene === undefined) return undefined;
    from.value = from.value.slice(0, -1);
    to.value = [...to.value, present];
    this.#lastEditMs = Number.NEGATIVE_INFINITY;
    return scene;
  }
}
