// Sends scenes to the server: at most one per screen refresh and one in flight. While one is in flight only the newest
// other scene is kept.
import type { Scene } from "../gen/thunderhead/v1/scene_pb";

export interface SenderSteps {
  // Resolves once the server accepted or refused the scene; rejects if it should be sent again.
  send(scene: Scene): Promise<void>;
  // Requests one call at the next screen refresh; returns a function that cancels it.
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

  // True while the newest scene is unanswered.
  get unsettled(): boolean {
    return this.#inFlight || this.#waiting !== undefined;
  }

  push(scene: Scene): void {
    this.#waiting = scene;
    this.#schedule();
  }

  // A session is ready. If `known` is given the session already has it, so older scenes are not sent.
  start(known?: Scene): void {
    this.#open = true;
    this.#starts += 1;
    this.#staleInFlight = this.#inFlight && known !== undefined;
    if (known !== undefined && this.#waiting === known) this.#waiting = undefined;
    this.#schedule();
  }

  // The connection is lost; the waiting scene is kept.
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
      // The `send` step reports the loss; start() is called once there is a session again.
      if (starts === this.#starts) this.stop();
    }
    this.#inFlight = false;
    this.#schedule();
  }
}
