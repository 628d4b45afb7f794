// Links to a session. The query ?session=VIEWER_KEY names the session. The fragment #scene=...
// contains a copy of the scene. If the session has ended, or if the link names no session, the link
// opens a new session with this scene. A link that names no session is called a link to a view. The
// fragment #present=PRESENTER_KEY lets another person or device present. Browsers do not send the
// fragment to the server, so no log contains the presenter's key.
import { sceneFromUrlText, sceneToUrlText } from "../core/scene";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";

export interface Link {
  readonly viewerKey: string | undefined;
  readonly presenterKey: string | undefined;
  readonly scene: Scene | undefined;
}

export function readLink(address: string): Link {
  const link = new URL(address);
  const fragment = new URLSearchParams(link.hash.slice(1));
  const text = fragment.get("scene");
  return {
    viewerKey: link.searchParams.get("session") ?? undefined,
    presenterKey: fragment.get("present") ?? undefined,
    scene: text === null ? undefined : sceneFromUrlText(text),
  };
}

// Returns the viewers' link. Without a scene the link is short enough for a QR code on a projector.
export function linkTo(address: string, viewerKey: string, scene?: Scene): string {
  const link = new URL(withoutLink(address));
  link.searchParams.set("session", viewerKey);
  if (scene !== undefined) link.hash = `scene=${sceneToUrlText(scene)}`;
  return link.href;
}

// Returns a link that opens a new session with that scene.
export function linkToView(address: string, scene: Scene): string {
  const link = new URL(withoutLink(address));
  link.hash = `scene=${sceneToUrlText(scene)}`;
  return link.href;
}

export function presentersLinkTo(address: string, viewerKey: string, presenterKey: string): string {
  const link = new URL(linkTo(address, viewerKey));
  link.hash = `present=${presenterKey}`;
  return link.href;
}

// Returns true for an address that means the machine on which it is opened.
export function isLoopback(address: string): boolean {
  const host = new URL(address).hostname;
  return /^(localhost|.*\.localhost|127(\.\d+){3}|0\.0\.0\.0|\[::1?\])$/.test(host);
}

// Returns the page's address without session and scene.
function withoutLink(address: string): string {
  const link = new URL(address);
  link.search = "";
  link.hash = "";
  return link.href;
}
