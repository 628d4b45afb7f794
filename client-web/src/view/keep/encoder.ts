// True if this browser can encode video. This is known without loading the code that writes movies.

export const NO_VIDEO_ENCODER =
  "the browser encodes video only on pages by HTTPS or from localhost";

export function encodesVideo(): boolean {
  return "VideoEncoder" in globalThis;
}
