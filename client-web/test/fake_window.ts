// Test support: the parts of a browser's window that the page uses.
import { vi } from "vitest";

export class FakeStorage {
  readonly items = new Map<string, string>();
  getItem(name: string): string | null {
    return this.items.get(name) ?? null;
  }
  setItem(name: string, text: string): void {
    this.items.set(name, text);
  }
}

type Listener = (event: object) => void;

class Target {
  readonly #listeners = new Map<string, Set<Listener>>();
  addEventListener(type: string, listener: Listener): void {
    const listeners = this.#listeners.get(type) ?? new Set();
    this.#listeners.set(type, listeners.add(listener));
  }
  tell(type: string, event: object = {}): void {
    for (const listener of this.#listeners.get(type) ?? []) listener({ type, ...event });
  }
}

export class FakeCanvas extends Target {
  clientWidth = 640;
  clientHeight = 360;
  width = 0;
  height = 0;
  readonly dataset: Record<string, string> = {};
  readonly classList = { add: () => undefined, remove: () => undefined };
  setPointerCapture(): void {}
  getBoundingClientRect() {
    return { left: 0, top: 0, width: this.clientWidth, height: this.clientHeight };
  }
  getContext() {
    return { fillRect: () => undefined, drawImage: () => undefined };
  }
  // Makes a gesture of the left button over these places.
  dragOver(places: readonly (readonly [number, number])[]): void {
    const event = (place: readonly [number, number] | undefined) => ({
      pointerId: 1,
      button: 0,
      buttons: 1,
      shiftKey: false,
      clientX: place?.[0] ?? 0,
      clientY: place?.[1] ?? 0,
      getCoalescedEvents: () => [],
    });
    this.tell("pointerdown", event(places[0]));
    for (const place of places.slice(1)) this.tell("pointermove", event(place));
    this.tell("pointerup", event(places.at(-1)));
  }
  hover(left: number, top: number): void {
    this.tell("pointermove", { pointerId: 1, clientX: left, clientY: top });
  }
}

export class FakeWindow extends Target {
  readonly document = Object.assign(new Target(), { hidden: false });
  readonly performance = performance;
  readonly devicePixelRatio = 1;
  readonly innerWidth = 1280;
  readonly location: { href: string; reload(): void };
  reloads = 0;
  readonly history = {
    replaceState: (_: unknown, __: string, address: string) => {
      this.location.href = address;
    },
  };
  constructor(
    address: string,
    readonly localStorage: FakeStorage,
  ) {
    super();
    this.location = {
      href: address,
      reload: () => {
        this.reloads += 1;
      },
    };
  }
  requestAnimationFrame(callback: (nowMs: number) => void): number {
    return setTimeout(() => callback(performance.now()), 16) as unknown as number;
  }
  cancelAnimationFrame(request: number): void {
    clearTimeout(request);
  }
  hide(hidden: boolean): void {
    this.document.hidden = hidden;
    this.document.tell("visibilitychange");
  }
}

// Replaces the browser's globals that the page uses.
export function stubGlobals(): void {
  vi.stubGlobal(
    "ResizeObserver",
    class {
      observe(): void {}
      disconnect(): void {}
    },
  );
  vi.stubGlobal("createImageBitmap", async () => ({
    width: 640,
    height: 360,
    close: () => undefined,
  }));
}
