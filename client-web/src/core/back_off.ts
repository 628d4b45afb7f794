// Exponential back-off with full jitter: a delay is drawn at random below a bound that doubles, so that a whole class does
// not come back at once.

// Also after a delay that the server gave, which is the same for everybody.
export const FIRST_BOUND_MS = 1000;
export const LONGEST_BOUND_MS = 8000;

export class BackOff {
  readonly #random: () => number;
  #attempts = 0;

  // `random` draws from 0 to 1.
  constructor(random: () => number = Math.random) {
    this.#random = random;
  }

  get attempts(): number {
    return this.#attempts;
  }

  // The delay before the next attempt; not below `leastMs`, which the server asked for.
  next(leastMs = 0): number {
    const bound = Math.min(LONGEST_BOUND_MS, FIRST_BOUND_MS * 2 ** Math.min(this.#attempts, 16));
    this.#attempts += 1;
    return leastMs + this.#random() * bound;
  }

  // An attempt succeeded.
  reset(): void {
    this.#attempts = 0;
  }
}
