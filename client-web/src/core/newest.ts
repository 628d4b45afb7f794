// Sends values at a limited rate: at most one value per interval, always the newest. The last value
// is always sent.

// Calls `callback` after the delay. Returns a function that cancels the call.
export type Later = (delayMs: number, callback: () => void) => () => void;

export class Newest<T> {
  readonly #intervalMs: number;
  readonly #later: Later;
  readonly #send: (value: T) => void;
  #waiting: { readonly value: T } | undefined;
  #withdraw: (() => void) | undefined;

  constructor(intervalMs: number, later: Later, send: (value: T) => void) {
    this.#intervalMs = intervalMs;
    this.#later = later;
    this.#send = send;
  }

  offer(value: T): void {
    this.#waiting = { value };
    if (this.#withdraw === undefined) this.#sendWaiting();
  }

  // Forgets a value that has not been sent.
  clear(): void {
    this.#waiting = undefined;
  }

  dispose(): void {
    this.clear();
    this.#withdraw?.();
    this.#withdraw = undefined;
  }

  #sendWaiting(): void {
    this.#withdraw = undefined;
    const waiting = this.#waiting;
    if (waiting === undefined) return;
    this.#waiting = undefined;
    this.#withdraw = this.#later(this.#intervalMs, () => this.#sendWaiting());
    this.#send(waiting.value);
  }
}
