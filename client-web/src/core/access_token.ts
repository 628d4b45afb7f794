// The token that a server with --auth asks for: kept for this tab alone, until it is closed.
import type { TextStore } from "./own_keys";

const TOKEN_ITEM = "thunderhead.token";

export class AccessToken {
  readonly #store: TextStore | undefined;
  // Used where the browser denies storage.
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
      // No room: it lasts as long as the page.
    }
  }
}

// Of a token in printable ASCII, as a header can carry it.
export function isToken(text: string): boolean {
  return /^[\x21-\x7e]+$/.test(text.trim());
}
