// Says whether this browser can encode video. This file is separate so that the code that writes
// movies need not be loaded.

export const NO_VIDEO_ENCODER =
  "the browser encodes video only on pages loaded by HTTPS or from localhost";

export function encodesVideo(): boolean {
  return "VideoEncoder" in globalThis;
}
