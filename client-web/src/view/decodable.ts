// Finds the encodings that this browser decodes: always JPEG, and often video (VP9) and AVIF. If it
// cannot decode video, also finds the reason.
import { Codec } from "../gen/thunderhead/v1/interact_pb";
import { VIDEO_CONFIG } from "./video_pictures";

export interface Decodable {
  readonly codecs: Codec[];
  // Why this browser cannot decode video; undefined if it can.
  readonly whyNoVideo: string | undefined;
}

type Probed = Pick<Window, "isSecureContext">;

export async function learnDecodable(window: Probed): Promise<Decodable> {
  const [whyNoVideo, avif] = await Promise.all([whyNotVideo(window), decodesAvif()]);
  const codecs = [Codec.JPEG];
  if (whyNoVideo === undefined) codecs.push(Codec.VP9);
  if (avif) codecs.push(Codec.AVIF);
  return { codecs, whyNoVideo };
}

async function whyNotVideo(window: Probed): Promise<string | undefined> {
  // Browsers hide WebCodecs in an insecure context.
  if (!window.isSecureContext) return "video needs HTTPS or localhost";
  if (typeof VideoDecoder === "undefined") return "this browser has no WebCodecs";
  try {
    const { supported } = await VideoDecoder.isConfigSupported(VIDEO_CONFIG);
    return supported ? undefined : "this browser cannot decode VP9";
  } catch {
    return "this browser cannot decode VP9";
  }
}

// An AVIF image of four grey pixels with 10 bits a channel.
const AVIF =
  "AAAAIGZ0eXBhdmlmAAAAAGF2aWZtaWYxbWlhZk1BMUEAAADybWV0YQAAAAAAAAAoaGRscgAAAAAAAAAAcGljdAAAAAAAAAAAAAAA" +
  "AGxpYmF2aWYAAAAADnBpdG0AAAAAAAEAAAAeaWxvYwAAAABEAAABAAEAAAABAAABGgAAABoAAAAoaWluZgAAAAAAAQAAABppbmZl" +
  "AgAAAAABAABhdjAxQ29sb3IAAAAAamlwcnAAAABLaXBjbwAAABRpc3BlAAAAAAAAAAIAAAACAAAAEHBpeGkAAAAAAwoKCgAAAAxh" +
  "djFDgSBAAAAAABNjb2xybmNseAABAA0AAYAAAAAXaXBtYQAAAAAAAAABAAEEAQKDBAAAACJtZGF0EgAKBzgANjAQ0BkyDRIAAggg" +
  "hABOIB3ZN4A=";

async function decodesAvif(): Promise<boolean> {
  try {
    const bytes = Uint8Array.from(atob(AVIF), (character) => character.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([bytes], { type: "image/avif" }));
    picture.close();
    return true;
  } catch {
    return false;
  }
}
