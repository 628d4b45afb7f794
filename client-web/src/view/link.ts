// Links to a session: ?session=VIEWER_KEY names it; #scene=... is a copy of the scene, to open a new session with if that
// one has ended. Browsers do not send the fragment to the server.
import { sceneFromUrlText, sceneToUrlText } from "../core/scene";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";

export interface Link {
  readonly viewerKey: string | undefined;
  readonly scene: Scene | undefined;
}

export function readLink(address: string): Link {
  const link = new URL(address);
  const text = new URLSearchParams(link.hash.slice(1)).get("scene");
  return {
    viewerKey: link.searchParams.get("session") ?? undefined,
    scene: text === null ? undefined : sceneFromUrlText(text),
  };
}

// Without a scene the link is short enough for a QR code that a projector shows.
export function linkTo(address: string, viewerKey: string, scene?: Scene): string {
  const link = new URL(withoutLink(address));
  link.searchParams.set("session", viewerKey);
  if (scene !== undefined) link.hash = `scene=${sceneToUrlText(scene)}`;
  return link.href;
}

// The page's address without session and scene.
function withoutLink(address: string): string {
  const link = new URL(address);
  link.search = "";
  link.hash = "";
  return link.href;
}
