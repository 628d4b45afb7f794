// Keeps the person's name and the presenter keys of this browser's sessions in the browser's
// storage. Each presenter key is found by its session's viewer key. A presenter's link contains a
// presenter key, which the page removes from the address at once.
import { KeptText, type TextStore } from "./kept_text";

const KEYS_ITEM = "thunderhead.presenter-keys";
const NAME_ITEM = "thunderhead.name";
const MAX_KEYS = 32;
export const LONGEST_NAME = 40;

type Entry = readonly [viewerKey: string, presenterKey: string];

export class OwnKeys {
  readonly #name: KeptText;
  readonly #entries: KeptText;

  constructor(store: TextStore | undefined) {
    this.#name = new KeptText(store, NAME_ITEM);
    this.#entries = new KeptText(store, KEYS_ITEM);
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
    return this.#name.read() ?? "";
  }

  set name(name: string) {
    this.#name.write(trimmedName(name));
  }

  #read(): readonly Entry[] {
    try {
      const parsed: unknown = JSON.parse(this.#entries.read() ?? "[]");
      return Array.isArray(parsed) ? parsed.filter(isEntry) : [];
    } catch {
      // Another program may have written a text that is not JSON.
      return [];
    }
  }

  #write(entries: readonly Entry[]): void {
    this.#entries.write(JSON.stringify(entries));
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
