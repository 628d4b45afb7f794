// The part of the DOM's Storage that the page uses.
export interface TextStore {
  getItem(name: string): string | null;
  setItem(name: string, text: string): void;
}

// A text under one name in the browser's storage. If the browser cannot store it, because its
// storage is full or denied, the text lasts only as long as the page.
export class KeptText {
  readonly #store: TextStore | undefined;
  readonly #name: string;
  // The newest text if it could not be stored. It counts instead of an older stored text.
  #unstored: string | undefined;

  constructor(store: TextStore | undefined, name: string) {
    this.#store = store;
    this.#name = name;
  }

  // Returns undefined if there is no text. Reads the storage each time, because another tab may
  // have changed it.
  read(): string | undefined {
    if (this.#unstored !== undefined) return this.#unstored;
    try {
      return this.#store?.getItem(this.#name) ?? undefined;
    } catch {
      return undefined;
    }
  }

  // Returns false if the text could not be stored.
  write(text: string): boolean {
    this.#unstored = text;
    try {
      if (this.#store === undefined) return false;
      this.#store.setItem(this.#name, text);
    } catch {
      return false;
    }
    this.#unstored = undefined;
    return true;
  }
}
