// The secret by which the server recognizes a person who joins a session again, so that this person
// still owns the earlier marks. The browser keeps it for this tab only, until the tab is closed.
import type { TextStore } from "./own_keys";

const PARTICIPANT_ITEM = "thunderhead.participant";

export class Participant {
  readonly #store: TextStore | undefined;
  // The session's key and the participant key, used if they could not be written to the browser's
  // storage.
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

  // Keeps the participant key of this session, and forgets the key of any other session.
  keep(sessionKey: string, participantKey: string): void {
    this.#kept = `${sessionKey} ${participantKey}`;
    try {
      this.#store?.setItem(PARTICIPANT_ITEM, this.#kept);
    } catch {
      // Writing fails if the storage is full. The key then lasts only as long as the page.
    }
  }
}
