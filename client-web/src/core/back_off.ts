// Exponential back-off with full jitter. Each delay is random below a bound, and the bound doubles
// after each attempt. Many clients that lose their server together therefore do not reconnect all
// at once.

export const FIRST_BOUND_MS = 1000;
export const LONGEST_BOUND_MS = 8000;

export class BackOff {
  readonly #random: () => number;
  #attempts = 0;

  // `random` returns a number from 0 to 1.
  constructor(random: () => number = Math.random) {
    this.#random = random;
  }

  get attempts(): number {
    return this.#attempts;
  }

  // Returns the delay before the next attempt: `leastMs`, the minimum delay that the server asked
  // for, plus a random delay. The random delay is added because the server asks all clients for the
  // same minimum.
  next(leastMs = 0): number {
    const bound = Math.min(LONGEST_BOUND_MS, FIRST_BOUND_MS * 2 ** Math.min(this.#attempts, 16));
    this.#attempts += 1;
    return leastMs + this.#random() * bound;
  }

  // Starts again with short delays after an attempt that succeeded.
  reset(): void {
    this.#attempts = 0;
  }
}
