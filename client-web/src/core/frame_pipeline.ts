// Decodes frames and paints them, dropping old ones: one frame is being decoded, one waits to be decoded, one waits to
// be painted, and a newer frame replaces a waiting one. So the page holds at most three frames, and latency cannot grow
// however slow decoding or painting is. The newest is the one that came last, whatever its number: the server sends a frame
// again, in another size or to a page that is seen again.

export interface PipelineSteps<F, P> {
  decode(frame: F): Promise<P>;
  // Requests one call at the next screen refresh; returns a function that cancels it.
  onNextPaint(callback: () => void): () => void;
  // Draws the picture; the frame counts as shown when this returns.
  paint(frame: F, picture: P): void;
  // Frees a picture that was replaced or never painted.
  release(picture: P): void;
  // The frame could not be decoded; a later one may.
  failed(frame: F, reason: unknown): void;
  // A newer frame has replaced it, or the stream has ended, before it was decoded.
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

  // Number of frames that were received but never painted, because a newer one was there.
  get dropped(): number {
    return this.#dropped;
  }

  // Frames of the old stream are dropped.
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
