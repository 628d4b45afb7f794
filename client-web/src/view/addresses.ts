// Makes the links of a session, and keeps the address of the presenter's page up to date. The
// address opens the session again. If the session has ended, the address opens a new session with
// the same scene.
import { effect } from "@preact/signals-core";
import type { OwnKeys } from "../core/own_keys";
import type { PageState } from "../core/state";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import { isLoopback, linkTo, linkToView, presentersLinkTo, readLink } from "./link";

// Delay before a changed scene is written into the address, because browsers limit how often it may
// change.
const REST_MS = 1000;

export class Addresses {
  readonly #window: Window;
  readonly #state: PageState;
  readonly #keys: OwnKeys;
  readonly #stopWatching: () => void;
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(window: Window, state: PageState, keys: OwnKeys) {
    this.#window = window;
    this.#state = state;
    this.#keys = keys;
    this.#stopWatching = effect(() => {
      if (state.scene.value !== undefined && state.session.presenting.value) this.#writeAfterRest();
    });
  }

  // Returns the viewers' link. If `withScene` is true, the link contains the scene, so that it can
  // open a new session after this session has ended.
  viewersLink(withScene = false): string | undefined {
    const viewerKey = this.#state.session.viewerKey.value;
    if (viewerKey === undefined) return undefined;
    const scene = withScene ? this.#state.scene.value : undefined;
    return linkTo(this.#window.location.href, viewerKey, scene);
  }

  // Returns a link that shows the scene in a new session.
  viewLink(scene: Scene): string {
    return linkToView(this.#window.location.href, scene);
  }

  // Returns a link for another person or device to present; undefined if this page does not
  // present.
  presentersLink(): string | undefined {
    const { viewerKey, presenting } = this.#state.session;
    if (viewerKey.value === undefined || !presenting.value) return undefined;
    const presenterKey = this.#keys.presenterKey(viewerKey.value);
    if (presenterKey === undefined) return undefined;
    return presentersLinkTo(this.#window.location.href, viewerKey.value, presenterKey);
  }

  // Returns the host name in the page's address if it means this machine, such as "localhost", so
  // that links do not work on other machines. Otherwise returns undefined.
  get loopbackHost(): string | undefined {
    const { href } = this.#window.location;
    return isLoopback(href) ? new URL(href).hostname : undefined;
  }

  // Stores the presenter key of a presenter's link and removes it from the address. Returns false
  // if the address is not a presenter's link. A key that is already stored for the session is not
  // replaced, so that a link cannot destroy it.
  adoptPresentersLink(): boolean {
    const { viewerKey, presenterKey, scene } = readLink(this.#window.location.href);
    if (viewerKey === undefined || presenterKey === undefined) return false;
    if (this.#keys.presenterKey(viewerKey) === undefined) this.#keys.keep(viewerKey, presenterKey);
    const address = linkTo(this.#window.location.href, viewerKey, scene);
    this.#window.history.replaceState(null, "", address);
    return true;
  }

  // Copies the link. Returns false if the browser denies the clipboard, for example to pages
  // without HTTPS or without focus.
  async copy(link: string): Promise<boolean> {
    try {
      await this.#window.navigator.clipboard.writeText(link);
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
