// The browser storage that the page uses. It holds the person's name and, by viewer key, the
// presenter keys of this browser's sessions. Only the presenter's link contains a presenter key in
// its address, and the page removes it from the address at once.

// The part of the DOM's Storage that the page uses.
export interface TextStore {
  getItem(name: string): string | null;
  setItem(name: string, text: string): void;
}

const KEYS_ITEM = "thunderhead.presenter-keys";
const NAME_ITEM = "thunderhead.name";
const MAX_KEYS = 32;
export const LONGEST_NAME = 40;

type Entry = readonly [viewerKey: string, presenterKey: string];

export class OwnKeys {
  readonly #store: TextStore | undefined;
  // These are used if the browser denies access to its storage.
  #name = "";
  #entries: readonly Entry[] = [];

  constructor(store: TextStore | undefined) {
    this.#store = store;
  }

  presenterKey(viewerKey: string): string | undefined {
    return this.#read().find(([viewers]) => viewers === viewerKey)?.[1];
  }

  keep(viewerKey: string, presenterKey: string): void {
    const others = this.#read().filter(([viewers]) => viewers !== viewerKey);
    this.#write([...others, [viewerKey, presenterKey] as const].slice(-MAX_KEYS));
  }

  forget(viewerKey: string): void {
    this.#write(this.#read().filter(([viewers]) => viewers !== viewerKey));
  }

  get name(): string {
    try {
      return this.#store?.getItem(NAME_ITEM) ?? this.#name;
    } catch {
      return this.#name;
    }
  }

  set name(name: string) {
    this.#name = trimmedName(name);
    this.#set(NAME_ITEM, this.#name);
  }

  #read(): readonly Entry[] {
    try {
      const text = this.#store?.getItem(KEYS_ITEM);
      if (text === null || text === undefined) return this.#entries;
      const parsed: unknown = JSON.parse(text);
      return Array.isArray(parsed) ? parsed.filter(isEntry) : [];
    } catch {
      return this.#entries;
    }
  }

  #write(entries: readonly Entry[]): void {
    this.#entries = entries;
    this.#set(KEYS_ITEM, JSON.stringify(entries));
  }

  #set(item: string, text: string): void {
    try {
      this.#store?.setItem(item, text);
    } catch {
      // The storage is full or denied, so the text lasts as long as the page.
    }
  }
}

// The length is counted in code points, as on the server.
export function trimmedName(name: string): string {
  return [...name.trim()].slice(0, LONGEST_NAME).join("");
}

function isEntry(value: unknown): value is Entry {
  return Array.isArray(value) && value.length === 2 && value.every((v) => typeof v === "string");
}
