// The link for viewers, and the address of the presenter's page, which always opens the session, or in place of one that has
// ended a new one with the same scene.
import { effect } from "@preact/signals-core";
import type { PageState } from "../core/state";
import { linkTo } from "./link";

// The address has the scene of at least so long ago; browsers limit how often it changes.
const REST_MS = 1000;

export class Addresses {
  readonly #window: Window;
  readonly #state: PageState;
  readonly #stopWatching: () => void;
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(window: Window, state: PageState) {
    this.#window = window;
    this.#state = state;
    this.#stopWatching = effect(() => {
      if (state.scene.value !== undefined && state.session.presenting.value) this.#writeAfterRest();
    });
  }

  // With the scene it can open a new session when this one has ended.
  viewersLink(withScene = false): string | undefined {
    const viewerKey = this.#state.session.viewerKey.value;
    if (viewerKey === undefined) return undefined;
    const scene = withScene ? this.#state.scene.value : undefined;
    return linkTo(this.#window.location.href, viewerKey, scene);
  }

  // False where the browser denies the clipboard, as to pages without HTTPS or without focus.
  async copyLink(): Promise<boolean> {
    try {
      await this.#window.navigator.clipboard.writeText(this.viewersLink(true) ?? "");
      return true;
    } catch {
      return false;
    }
  }

  write(): void {
    const address = this.viewersLink(true);
    if (address !== undefined) this.#window.history.replaceState(null, "", address);
  }

  dispose(): void {
    this.#stopWatching();
    clearTimeout(this.#timer);
  }

  #writeAfterRest(): void {
    this.#timer ??= setTimeout(() => {
      this.#timer = undefined;
      if (this.#state.session.presenting.peek()) this.write();
    }, REST_MS);
  }
}
