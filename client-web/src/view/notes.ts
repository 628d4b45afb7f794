// Shows notices, of which some disappear automatically.
import type { PageState } from "../core/state";

const NOTE_MS = 6000;

export class Notes {
  readonly #state: PageState;
  // The timers of the notices that disappear automatically, by the notices' subjects.
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

  // Shows a notice that stays until it is dismissed or replaced.
  problem(subject: string, text: string): void {
    this.#keep(subject);
    this.#state.notify({ subject, text, severity: "problem" });
  }

  dispose(): void {
    for (const timer of this.#timers.values()) clearTimeout(timer);
  }

  // Stops the timer of the notice on this subject, because a newer notice replaces it.
  #keep(subject: string): void {
    clearTimeout(this.#timers.get(subject));
    this.#timers.delete(subject);
  }
}
