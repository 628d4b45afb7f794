// Notices that disappear by themselves.
import type { PageState } from "../core/state";

const NOTE_MS = 6000;

export class Notes {
  readonly #state: PageState;
  readonly #timers = new Set<ReturnType<typeof setTimeout>>();

  constructor(state: PageState) {
    this.#state = state;
  }

  say(subject: string, text: string): void {
    this.#state.notify({ subject, text, severity: "note" });
    const timer = setTimeout(() => {
      this.#timers.delete(timer);
      this.#state.dismiss(subject);
    }, NOTE_MS);
    this.#timers.add(timer);
  }

  // Stays until it is dismissed, or said again.
  problem(subject: string, text: string): void {
    this.#state.notify({ subject, text, severity: "problem" });
  }

  dispose(): void {
    for (const timer of this.#timers) clearTimeout(timer);
  }
}
