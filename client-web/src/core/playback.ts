// Plays a storm's times at a chosen rate. It waits for the picture of one time before it continues
// with the next.
import { type ReadonlySignal, type Signal, signal } from "@preact/signals-core";

export interface PlaybackSteps {
  timeCount(): number;
  timeIndex(): number;
  // Returns true once the picture of this time is on the screen.
  isShown(index: number): boolean;
  // Shows a time. `plays` is true if playback rather than the person chose it.
  showTime(index: number, plays: boolean): void;
  // Requests one call at the next screen refresh. Returns a function that cancels it.
  onNextPaint(callback: (nowMs: number) => void): () => void;
}

export const PLAY_RATES = [0.5, 1, 2, 4, 8, 15] as const;

export class Playback {
  readonly #steps: PlaybackSteps;
  readonly #playing = signal(false);
  readonly timesPerSecond: Signal<number> = signal(2);
  // If false, playback stops at the last time.
  readonly loops: Signal<boolean> = signal(true);
  #lastStepMs: number | undefined;
  #withdrawPaint: (() => void) | undefined;

  constructor(steps: PlaybackSteps) {
    this.#steps = steps;
  }

  get playing(): ReadonlySignal<boolean> {
    return this.#playing;
  }

  toggle(): void {
    if (this.#playing.value) this.pause();
    else this.play();
  }

  play(): void {
    if (this.#playing.value || this.#steps.timeCount() < 2) return;
    if (!this.loops.value && this.#atEnd()) this.#steps.showTime(0, true);
    this.#playing.value = true;
    this.#lastStepMs = undefined;
    this.#await();
  }

  pause(): void {
    this.#playing.value = false;
    this.#withdrawPaint?.();
    this.#withdrawPaint = undefined;
  }

  // Shows the time `by` steps later, and wraps around at the ends. Stops playback so that this time
  // stays on the screen.
  step(by: number): void {
    this.pause();
    this.#step(by, false);
  }

  dispose(): void {
    this.pause();
  }

  #step(by: number, plays: boolean): void {
    const count = this.#steps.timeCount();
    if (count < 1) return;
    this.#steps.showTime((((this.#steps.timeIndex() + by) % count) + count) % count, plays);
  }

  #atEnd(): boolean {
    return this.#steps.timeIndex() >= this.#steps.timeCount() - 1;
  }

  #await(): void {
    this.#withdrawPaint = this.#steps.onNextPaint((nowMs) => this.#tick(nowMs));
  }

  #tick(nowMs: number): void {
    if (!this.#playing.value) return;
    const shown = this.#steps.isShown(this.#steps.timeIndex());
    const intervalMs = 1000 / this.timesPerSecond.value;
    const due = this.#lastStepMs === undefined || nowMs - this.#lastStepMs >= intervalMs;
    if (shown && due) {
      if (this.#steps.timeCount() < 2 || (!this.loops.value && this.#atEnd())) {
        this.pause();
        return;
      }
      this.#lastStepMs = nowMs;
      this.#step(1, true);
    }
    this.#await();
  }
}
