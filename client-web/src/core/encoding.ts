// Functions about the encoding of a frame's picture (JPEG, video or AVIF).
import type { Frame } from "../gen/thunderhead/v1/frame_pb";

export type Encoding = "jpeg" | "vp9" | "avif";

type Encoded = Pick<Frame, "jpeg" | "vp9" | "avif">;

export function encodingOf(frame: Encoded): Encoding {
  if (frame.vp9.byteLength > 0) return "vp9";
  return frame.avif.byteLength > 0 ? "avif" : "jpeg";
}

export function pictureBytes(frame: Encoded): number {
  return frame[encodingOf(frame)].byteLength;
}

// Returns the encoding's name for people. Pass PageState.whyNoVideo as `whyNoVideo`.
export function nameOfEncoding(encoding: Encoding, whyNoVideo: string | undefined): string {
  if (encoding === "vp9") return "VP9 video";
  const name = encoding === "avif" ? "AVIF, 10 bits" : "JPEG";
  return whyNoVideo === undefined ? name : `${name}; ${whyNoVideo}`;
}
