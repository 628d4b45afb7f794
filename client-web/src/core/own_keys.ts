// Keeps the person's name and the presenter keys of this browser's sessions in the browser's
// storage. Each presenter key is found by its session's viewer key. A presenter's link contains a
// presenter key, which the page removes from the address at once.

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
  // These members are used if the browser denies access to its storage.
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
      // Writing fails if the storage is full or denied. The text then lasts only as long as the
      // page.
    }
  }
}

// Returns the name without surrounding spaces, cut to LONGEST_NAME code points. The server also
// counts code points.
export function trimmedName(name: string): string {
  return [...name.trim()].slice(0, LONGEST_NAME).join("");
}

function isEntry(value: unknown): value is Entry {
  return Array.isArray(value) && value.length === 2 && value.every((v) => typeof v === "string");
}
