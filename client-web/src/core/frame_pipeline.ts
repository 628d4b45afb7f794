// Decodes frames and paints them, and drops old frames. At most one frame is being decoded, one
// waits to be decoded, and one waits to be painted. A newer frame replaces a waiting frame. The
// page therefore holds at most three frames, and latency cannot grow however slow decoding or
// painting is. The newest frame is the last to arrive, whatever its sequence number. The server may
// send a frame again, for example in another size or when a hidden page becomes visible.

export interface PipelineSteps<F, P> {
  decode(frame: F): Promise<P>;
  // Requests one call at the next screen refresh. Returns a function that cancels it.
  onNextPaint(callback: () => void): () => void;
  // Draws the picture. The frame counts as shown when this returns.
  paint(frame: F, picture: P): void;
  // Frees a picture that was replaced or never painted.
  release(picture: P): void;
  // Reports that the frame could not be decoded. A later frame may succeed.
  failed(frame: F, reason: unknown): void;
  // Reports that the frame was replaced by a newer one, or that its stream ended, while it waited
  // to be decoded.
  skipped?(frame: F): void;
}

export class FramePipeline<F, P> {
  readonly #steps: PipelineSteps<F, P>;
  #stream = 0;
  #decoding: F | undefined;
  #waiting: F | undefined;
  #ready: { frame: F; picture: P } | undefined;
  #withdrawPaint: (() => void) | undefined;
  #disposed = false;
  #dropped = 0;

  constructor(steps: PipelineSteps<F, P>) {
    this.#steps = steps;
  }

  // Returns the number of frames that were replaced by newer frames before they were painted.
  get dropped(): number {
    return this.#dropped;
  }

  // Drops the frames of the old stream.
  startStream(): void {
    this.#stream += 1;
    this.#decoding = undefined;
    if (this.#waiting !== undefined) this.#steps.skipped?.(this.#waiting);
    this.#waiting = undefined;
    this.#discardReady();
  }

  offer(frame: F): void {
    if (this.#disposed) return;
    if (this.#decoding !== undefined) {
      if (this.#waiting !== undefined) {
        this.#steps.skipped?.(this.#waiting);
        this.#dropped += 1;
      }
      this.#waiting = frame;
      return;
    }
    void this.#decode(frame);
  }

  dispose(): void {
    this.#disposed = true;
    this.startStream();
  }

  async #decode(frame: F): Promise<void> {
    const stream = this.#stream;
    this.#decoding = frame;
    try {
      const picture = await this.#steps.decode(frame);
      if (stream === this.#stream) this.#keepForPaint(frame, picture);
      else this.#steps.release(picture);
    } catch (reason) {
      if (stream === this.#stream) this.#steps.failed(frame, reason);
    }
    if (stream !== this.#stream) return;
    this.#decoding = undefined;
    const next = this.#waiting;
    this.#waiting = undefined;
    if (next !== undefined) void this.#decode(next);
  }

  #keepForPaint(frame: F, picture: P): void {
    if (this.#ready !== undefined) {
      this.#steps.release(this.#ready.picture);
      this.#dropped += 1;
    }
    this.#ready = { frame, picture };
    this.#withdrawPaint ??= this.#steps.onNextPaint(() => this.#paint());
  }

  #paint(): void {
    this.#withdrawPaint = undefined;
    const ready = this.#ready;
    this.#ready = undefined;
    if (ready !== undefined) this.#steps.paint(ready.frame, ready.picture);
  }

  #discardReady(): void {
    this.#withdrawPaint?.();
    this.#withdrawPaint = undefined;
    if (this.#ready !== undefined) this.#steps.release(this.#ready.picture);
    this.#ready = undefined;
  }
}
