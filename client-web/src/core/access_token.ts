// The token that a server with --auth requires. The browser keeps it for this tab only, until the
// tab is closed.
import { KeptText, type TextStore } from "./kept_text";

const TOKEN_ITEM = "thunderhead.token";

export class AccessToken {
  readonly #kept: KeptText;

  constructor(store: TextStore | undefined) {
    this.#kept = new KeptText(store, TOKEN_ITEM);
  }

  get value(): string | undefined {
    return this.#kept.read();
  }

  set(text: string): void {
    this.#kept.write(text.trim());
  }
}

// Returns true for a token in printable ASCII, which an HTTP header can carry.
export function isToken(text: string): boolean {
  return /^[\x21-\x7e]+$/.test(text.trim());
}
