// Plays a storm's times at a chosen rate, and waits for the picture of one time before it goes on to the next.
import { type ReadonlySignal, type Signal, signal } from "@preact/signals-core";

export interface PlaybackSteps {
  timeCount(): number;
  timeIndex(): number;
  // True once the picture of this time is on the screen.
  isShown(index: number): boolean;
  // `plays` where nobody has asked for this very time.
  showTime(index: number, plays: boolean): void;
  // Requests one call at the next screen refresh; returns a function that cancels it.
  onNextPaint(callback: (nowMs: number) => void): () => void;
}

export const PLAY_RATES = [0.5, 1, 2, 4, 8, 15] as const;

export class Playback {
  readonly #steps: PlaybackSteps;
  readonly #playing = signal(false);
  readonly timesPerSecond: Signal<number> = signal(2);
  // False: play ends at the last time.
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

  // One time forward or back, wrapping around at the ends. Ends play: this time is to stay.
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
      if (!this.loops.value && this.#atEnd()) {
        this.pause();
        return;
      }
      this.#lastStepMs = nowMs;
      this.#step(1, true);
    }
    this.#await();
  }
}
