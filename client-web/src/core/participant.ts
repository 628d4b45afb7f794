// The secret by which the server recognizes a person who joins a session again, so that this person
// still owns the earlier marks. The browser keeps it for this tab only, until the tab is closed.
import { KeptText, type TextStore } from "./kept_text";

const PARTICIPANT_ITEM = "thunderhead.participant";

export class Participant {
  // The session's key and the participant key.
  readonly #kept: KeptText;

  constructor(store: TextStore | undefined) {
    this.#kept = new KeptText(store, PARTICIPANT_ITEM);
  }

  // Returns the participant key; empty before this tab has joined the session.
  keyFor(sessionKey: string): string {
    const [session, key] = this.#kept.read()?.split(" ") ?? [];
    return session === sessionKey ? (key ?? "") : "";
  }

  // Keeps the participant key of this session, and forgets the key of any other session.
  keep(sessionKey: string, participantKey: string): void {
    this.#kept.write(`${sessionKey} ${participantKey}`);
  }
}
