// The secret by which the server recognizes a person who joins a session again, so that this person
// still owns the earlier marks. The browser keeps it for this tab only, until the tab is closed.
import type { TextStore } from "./own_keys";

const PARTICIPANT_ITEM = "thunderhead.participant";

export class Participant {
  readonly #store: TextStore | undefined;
  // This is used if the browser denies access to its storage.
  #kept: string | undefined;

  constructor(store: TextStore | undefined) {
    this.#store = store;
  }

  // Returns the participant key; empty before this tab has joined the session.
  keyFor(sessionKey: string): string {
    const kept = this.#store?.getItem(PARTICIPANT_ITEM) ?? this.#kept;
    const [session, key] = kept?.split(" ") ?? [];
    return session === sessionKey ? (key ?? "") : "";
  }

  // Keeps the key of this session, and forgets that of any other session.
  keep(sessionKey: string, participantKey: string): void {
    this.#kept = `${sessionKey} ${participantKey}`;
    try {
      this.#store?.setItem(PARTICIPANT_ITEM, this.#kept);
    } catch {
      // The storage is full, so the key lasts as long as the page.
    }
  }
}
