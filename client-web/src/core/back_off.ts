// Exponential back-off: delays double from a quarter of a second to four seconds.

export const FIRST_DELAY_MS = 250;
export const LONGEST_DELAY_MS = 4000;

export class BackOff {
  #attempts = 0;

  get attempts(): number {
    return this.#attempts;
  }

  // The delay before the next attempt.
  next(): number {
    const delay = Math.min(LONGEST_DELAY_MS, FIRST_DELAY_MS * 2 ** Math.min(this.#attempts, 16));
    this.#attempts += 1;
    return delay;
  }

  // An attempt succeeded.
  reset(): void {
    this.#attempts = 0;
  }
}
