// Encodes pictures to a movie in the browser. A WebM file contains VP9, or VP8 if the browser
// cannot encode VP9. An MP4 file contains H.264, or VP9 if the browser cannot encode H.264. This
// code is loaded with the first movie.
import {
  BufferTarget,
  CanvasSource,
  canEncodeVideo,
  Mp4OutputFormat,
  Output,
  QUALITY_HIGH,
  type VideoCodec,
  WebMOutputFormat,
} from "mediabunny";
import type { PictureSize } from "../../core/camera";
import type { MovieDraft } from "../../core/movie_plan";
import { encodesVideo, NO_VIDEO_ENCODER } from "./encoder";

export interface MovieFile {
  add(picture: OffscreenCanvas): Promise<void>;
  finish(): Promise<Uint8Array<ArrayBuffer>>;
  cancel(): Promise<void>;
}

const CODECS: Readonly<Record<MovieDraft["format"], readonly VideoCodec[]>> = {
  webm: ["vp9", "vp8"],
  mp4: ["avc", "vp9"],
};

type FileForm = Pick<MovieDraft, "format"> & PictureSize;

// Video encoders require even sides.
const sidesOf = ({ widthPx, heightPx }: PictureSize) => [widthPx & ~1, heightPx & ~1] as const;

// Returns the codec of that movie's file. Throws an Error with a message for people if this browser
// cannot encode such a video.
export function codecOf({ format, ...size }: FileForm): Promise<VideoCodec> {
  return encodable(format, ...sidesOf(size));
}

// Starts a movie. Throws the same errors as codecOf.
export async function startMovie(draft: MovieDraft): Promise<MovieFile> {
  const [width, height] = sidesOf(draft);
  const codec = await codecOf(draft);
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d", { alpha: false });
  if (context === null) throw new Error("this browser cannot draw on a canvas");
  const target = new BufferTarget();
  const format = draft.format === "webm" ? new WebMOutputFormat() : new Mp4OutputFormat();
  const output = new Output({ format, target });
  const source = new CanvasSource(canvas, { codec, bitrate: QUALITY_HIGH });
  output.addVideoTrack(source, { frameRate: draft.picturesPerSecond });
  await output.start();
  const seconds = 1 / draft.picturesPerSecond;
  let count = 0;
  return {
    async add(picture) {
      context.drawImage(picture, 0, 0, width, height);
      await source.add(count * seconds, seconds);
      count += 1;
    },
    async finish() {
      await output.finalize();
      if (target.buffer === null)
        throw new Error("the video encoder returned no file; try the other format");
      return new Uint8Array(target.buffer);
    },
    cancel: () => output.cancel(),
  };
}

async function encodable(
  format: MovieDraft["format"],
  width: number,
  height: number,
): Promise<VideoCodec> {
  if (!encodesVideo()) throw new Error(NO_VIDEO_ENCODER);
  for (const codec of CODECS[format])
    if (await canEncodeVideo(codec, { width, height })) return codec;
  throw new Error(
    `this browser cannot encode ${format === "webm" ? "WebM" : "MP4"} at this size; try a smaller size or the other format`,
  );
}
