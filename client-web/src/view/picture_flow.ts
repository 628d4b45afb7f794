// Frames on their way to the canvas: of the session's view, or of the own view of a person who looks around. Every frame is
// acknowledged, shown or not: the server waits for that. Pictures of video are decoded as they come, as the next ones need
// them; of files only the newest.

import { FramePipeline } from "../core/frame_pipeline";
import type { Frame } from "../gen/thunderhead/v1/frame_pb";
import { CanvasPainter, type Picture } from "./canvas_painter";
import { VideoPictures } from "./video_pictures";

export interface PictureFlowSteps {
  // `videoLost` if it was video that could not be decoded.
  acknowledge(sequence: bigint, ownView: boolean, videoLost?: boolean): void;
  // True while frames of the own view are to be shown.
  wantsOwnView(): boolean;
  painted(frame: Frame): void;
  undecodable(frame: Frame): void;
  onNextPaint(callback: () => void): () => void;
}

// A frame whose video is being decoded already.
interface Arrived {
  readonly frame: Frame;
  readonly video: Promise<VideoFrame> | undefined;
}

export class PictureFlow {
  readonly #steps: PictureFlowSteps;
  readonly #pipeline: FramePipeline<Arrived, Picture>;
  readonly #video = new VideoPictures();
  #painter: CanvasPainter | undefined;
  #showsOwnView = false;
  #newestSequence: bigint | undefined;
  // The newest frame of the session's view that came while the own one was shown.
  #unwanted: Frame | undefined;

  constructor(steps: PictureFlowSteps) {
    this.#steps = steps;
    this.#pipeline = new FramePipeline({
      decode: ({ frame, video }): Promise<Picture> => video ?? decodeFile(frame),
      onNextPaint: (callback) => steps.onNextPaint(callback),
      paint: ({ frame }, picture) => this.#paint(frame, picture),
      release: (picture) => picture.close(),
      failed: ({ frame }) => this.#undecodable(frame),
      skipped: ({ frame, video }) => this.#skipped(frame, video),
    });
  }

  attach(canvas: HTMLCanvasElement): CanvasPainter {
    this.#painter = new CanvasPainter(canvas);
    return this.#painter;
  }

  detach(): void {
    this.#painter?.dispose();
    this.#painter = undefined;
  }

  // A new call: sequences count from the beginning.
  startCall(): void {
    this.#video.reset();
    this.#pipeline.startStream();
    this.#newestSequence = undefined;
    this.#unwanted = undefined;
  }

  offer(frame: Frame): void {
    if (frame.ownView !== this.#steps.wantsOwnView()) {
      this.#steps.acknowledge(frame.sequence, frame.ownView);
      if (!frame.ownView) this.#unwanted = frame;
      // The next pictures of its stream would need it.
      if (frame.vp9.byteLength > 0 && frame.ownView === this.#showsOwnView) this.#video.reset();
      return;
    }
    if (frame.ownView !== this.#showsOwnView) this.#switchTo(frame.ownView);
    this.#newestSequence = frame.sequence;
    const video =
      frame.vp9.byteLength > 0 ? this.#video.decode(frame.vp9, frame.keyFrame) : undefined;
    // It is told by the pipeline, or by #skipped.
    video?.catch(() => undefined);
    this.#pipeline.offer({ frame, video });
  }

  // Another view is wanted now. The server may have sent its frame before it said so.
  viewChanged(): void {
    const frame = this.#unwanted;
    this.#unwanted = undefined;
    if (frame !== undefined && !this.#steps.wantsOwnView()) this.offer(frame);
  }

  dispose(): void {
    this.#pipeline.dispose();
    this.#video.reset();
    this.detach();
  }

  // The views count their sequences apart. What waits of the other is not shown any more.
  #switchTo(ownView: boolean): void {
    if (this.#newestSequence !== undefined)
      this.#steps.acknowledge(this.#newestSequence, this.#showsOwnView);
    this.startCall();
    this.#showsOwnView = ownView;
  }

  #paint(frame: Frame, picture: Picture): void {
    if (this.#painter === undefined) {
      picture.close();
      return;
    }
    this.#painter.paint(picture);
    this.#steps.acknowledge(frame.sequence, frame.ownView);
    this.#steps.painted(frame);
  }

  // Video that breaks off is no news to anybody: the server goes on with JPEG.
  #undecodable(frame: Frame): void {
    const isVideo = frame.vp9.byteLength > 0;
    this.#steps.acknowledge(frame.sequence, frame.ownView, isVideo);
    if (!isVideo) this.#steps.undecodable(frame);
  }

  #skipped(frame: Frame, video: Promise<VideoFrame> | undefined): void {
    video?.then(
      (picture) => picture.close(),
      () => this.#steps.acknowledge(frame.sequence, frame.ownView, true),
    );
  }
}

function decodeFile(frame: Frame): Promise<ImageBitmap> {
  const isStill = frame.avif.byteLength > 0;
  // Blob does not accept shared buffers; decoded messages never use them.
  const bytes = (isStill ? frame.avif : frame.jpeg) as Uint8Array<ArrayBuffer>;
  return createImageBitmap(new Blob([bytes], { type: isStill ? "image/avif" : "image/jpeg" }));
}
