// The token that a server with --auth requires. The browser keeps it for this tab only, until the
// tab is closed.
import type { TextStore } from "./own_keys";

const TOKEN_ITEM = "thunderhead.token";

export class AccessToken {
  readonly #store: TextStore | undefined;
  // The token, used if it could not be written to the browser's storage.
  #token: string | undefined;

  constructor(store: TextStore | undefined) {
    this.#store = store;
  }

  get value(): string | undefined {
    const stored = this.#store?.getItem(TOKEN_ITEM) ?? undefined;
    return stored ?? this.#token;
  }

  set(text: string): void {
    this.#token = text.trim();
    try {
      this.#store?.setItem(TOKEN_ITEM, this.#token);
    } catch {
      // Writing fails if the storage is full. The token then lasts only as long as the page.
    }
  }
}

// Returns true for a token in printable ASCII, which an HTTP header can carry.
export function isToken(text: string): boolean {
  return /^[\x21-\x7e]+$/.test(text.trim());
}
