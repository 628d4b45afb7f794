// Counts frames and bytes over the last WINDOW_MS milliseconds.

const WINDOW_MS = 2000;

export class FrameRate {
  #frames: { atMs: number; bytes: number }[] = [];

  shown(bytes: number, nowMs: number): void {
    this.#frames.push({ atMs: nowMs, bytes });
    this.#forget(nowMs);
  }

  // Returns the number of frames per second; zero if no frame was shown in the last WINDOW_MS
  // milliseconds.
  framesPerSecond(nowMs: number): number {
    this.#forget(nowMs);
    return (this.#frames.length * 1000) / WINDOW_MS;
  }

  bytesPerSecond(nowMs: number): number {
    this.#forget(nowMs);
    return (this.#frames.reduce((sum, frame) => sum + frame.bytes, 0) * 1000) / WINDOW_MS;
  }

  #forget(nowMs: number): void {
    const oldest = nowMs - WINDOW_MS;
    this.#frames = this.#frames.filter((frame) => frame.atMs > oldest);
  }
}
