// Scenes to the server: at most one a screen refresh and one in flight; while one is in flight the newest
// waits and replaces the one that waited before it.
import type { Scene } from "../gen/thunderhead/v1/scene_pb";

export interface SenderSteps {
  // Resolves when the server took the scene or refused it for good, rejects when it should be sent again.
  send(scene: Scene): Promise<void>;
  // Asks for one call at the next screen refresh; returns what withdraws it.
  onNextPaint(callback: () => void): () => void;
}

export class SceneSender {
  readonly #steps: SenderSteps;
  #waiting: Scene | undefined;
  #inFlight = false;
  #open = false;
  #starts = 0;
  #staleInFlight = false;
  #withdrawPaint: (() => void) | undefined;

  constructor(steps: SenderSteps) {
    this.#steps = steps;
  }

  // True where the server has not yet answered the newest scene.
  get unsettled(): boolean {
    return this.#inFlight || this.#waiting !== undefined;
  }

  push(scene: Scene): void {
    this.#waiting = scene;
    this.#schedule();
  }

  // There is a session to send to. It already holds `known`, if given, and so nothing older than that.
  start(known?: Scene): void {
    this.#open = true;
    this.#starts += 1;
    this.#staleInFlight = this.#inFlight && known !== undefined;
    if (known !== undefined && this.#waiting === known) this.#waiting = undefined;
    this.#schedule();
  }

  // The session is out of reach; what waits is kept.
  stop(): void {
    this.#open = false;
    this.#withdrawPaint?.();
    this.#withdrawPaint = undefined;
  }

  #schedule(): void {
    if (!this.#open || this.#inFlight || this.#waiting === undefined) return;
    this.#withdrawPaint ??= this.#steps.onNextPaint(() => {
      this.#withdrawPaint = undefined;
      void this.#send();
    });
  }

  async #send(): Promise<void> {
    const scene = this.#waiting;
    if (scene === undefined || this.#inFlight || !this.#open) return;
    this.#waiting = undefined;
    this.#inFlight = true;
    this.#staleInFlight = false;
    const starts = this.#starts;
    try {
      await this.#steps.send(scene);
    } catch {
      if (!this.#staleInFlight) this.#waiting ??= scene;
      // Whoever sends reports the loss and calls start() when there is a session again.
      if (starts === this.#starts) this.stop();
    }
    this.#inFlight = false;
    this.#schedule();
  }
}
