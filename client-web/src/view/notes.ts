// Notices that disappear by themselves.
import type { PageState } from "../core/state";

const NOTE_MS = 6000;

export class Notes {
  readonly #state: PageState;
  // Of the notices that disappear, by their subjects.
  readonly #timers = new Map<string, ReturnType<typeof setTimeout>>();

  constructor(state: PageState) {
    this.#state = state;
  }

  say(subject: string, text: string): void {
    this.#keep(subject);
    this.#state.notify({ subject, text, severity: "note" });
    const timer = setTimeout(() => {
      this.#timers.delete(subject);
      this.#state.dismiss(subject);
    }, NOTE_MS);
    this.#timers.set(subject, timer);
  }

  // Stays until it is dismissed, or said again.
  problem(subject: string, text: string): void {
    this.#keep(subject);
    this.#state.notify({ subject, text, severity: "problem" });
  }

  dispose(): void {
    for (const timer of this.#timers.values()) clearTimeout(timer);
  }

  // An older notice on it goes no more, as a newer one has its place.
  #keep(subject: string): void {
    clearTimeout(this.#timers.get(subject));
    this.#timers.delete(subject);
  }
}
