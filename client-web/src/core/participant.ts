// The secret by which the server knows somebody who comes back to a session, whose marks then stay the own ones: kept for
// this tab alone, until it is closed.
import type { TextStore } from "./own_keys";

const PARTICIPANT_ITEM = "thunderhead.participant";

export class Participant {
  readonly #store: TextStore | undefined;
  // Used where the browser denies storage.
  #kept: string | undefined;

  constructor(store: TextStore | undefined) {
    this.#store = store;
  }

  // Empty before the session of that key was joined.
  keyFor(sessionKey: string): string {
    const kept = this.#store?.getItem(PARTICIPANT_ITEM) ?? this.#kept;
    const [session, key] = kept?.split(" ") ?? [];
    return session === sessionKey ? (key ?? "") : "";
  }

  // Forgets that of any other session.
  keep(sessionKey: string, participantKey: string): void {
    this.#kept = `${sessionKey} ${participantKey}`;
    try {
      this.#store?.setItem(PARTICIPANT_ITEM, this.#kept);
    } catch {
      // No room: it lasts as long as the page.
    }
  }
}
