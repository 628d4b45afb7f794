// True if this browser encodes video at all; known without the part that writes movies.

export const NO_VIDEO_ENCODER =
  "the browser encodes video only on pages by HTTPS or from localhost";

export function encodesVideo(): boolean {
  return "VideoEncoder" in globalThis;
}
