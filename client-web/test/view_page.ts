// Test support: pages with the fake service, in simulated time.
import { vi } from "vitest";
import { Page } from "../src/view/page";
import { FakeNetwork } from "./fake_network";
import { FakeService } from "./fake_service";
import type { FakeSession } from "./fake_session";
import { FakeCanvas, FakeStorage, FakeWindow, stubGlobals } from "./fake_window";

export const HOME = "http://host/storms/";
export const pass = (ms: number) => vi.advanceTimersByTimeAsync(ms);

export interface Visited {
  readonly page: Page;
  readonly window: FakeWindow;
  readonly canvas: FakeCanvas;
}

export class Visits {
  readonly service = new FakeService(() => new Uint8Array([1]));
  readonly network = new FakeNetwork(this.service);
  readonly #pages: Page[] = [];

  constructor() {
    vi.useFakeTimers();
    stubGlobals();
  }

  async visit(address = HOME, storage = new FakeStorage()): Promise<Visited> {
    const window = new FakeWindow(address, storage);
    const page = new Page(this.network.transport(), this.network.openInteract, window as never);
    this.#pages.push(page);
    const canvas = new FakeCanvas();
    page.attachCanvas(canvas as never);
    await pass(600);
    return { page, window, canvas };
  }

  // Returns the session that was opened first.
  get session(): FakeSession {
    const [first] = this.service.sessions;
    if (first === undefined) throw new Error("there is no session");
    return first;
  }

  end(): void {
    for (const page of this.#pages) page.dispose();
    vi.unstubAllGlobals();
    vi.useRealTimers();
  }
}
