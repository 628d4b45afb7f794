// Passes frames from the network to the canvas. The frames show either the session's view, or the
// own view of a person who looks around. The server waits for acknowledgements, each of which
// covers all earlier frames of the same view. A frame is acknowledged when it is shown, cannot be
// decoded or belongs to the other view. A waiting frame that is replaced by a newer frame is
// covered by the newer frame's acknowledgement. Every video frame is decoded on arrival, because
// later frames depend on it. Of JPEG and AVIF frames only the newest is decoded.

import { FramePipeline } from "../core/frame_pipeline";
import type { Frame } from "../gen/thunderhead/v1/frame_pb";
import { CanvasPainter, type Picture } from "./canvas_painter";
import { VideoPictures } from "./video_pictures";

export interface PictureFlowSteps {
  // `videoLost` is true for video that could not be decoded.
  acknowledge(sequence: bigint, ownView: boolean, videoLost?: boolean): void;
  // Returns true while frames of the own view should be shown.
  wantsOwnView(): boolean;
  painted(frame: Frame): void;
  undecodable(frame: Frame): void;
  onNextPaint(callback: () => void): () => void;
}

// A frame. If it is a video frame, `video` is the result of its decoding, which has already begun.
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
  // The newest frame of the session's view that arrived while the own view was shown.
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

  // Begins a new call, whose sequence numbers restart.
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
      // Later frames of this stream would depend on the skipped frame, so the decoder waits for the
      // next key frame.
      if (frame.vp9.byteLength > 0 && frame.ownView === this.#showsOwnView) this.#video.reset();
      return;
    }
    if (frame.ownView !== this.#showsOwnView) this.#switchTo(frame.ownView);
    this.#newestSequence = frame.sequence;
    const video =
      frame.vp9.byteLength > 0 ? this.#video.decode(frame.vp9, frame.keyFrame) : undefined;
    // The pipeline or #skipped handles a decoding error, so it is ignored here.
    video?.catch(() => undefined);
    this.#pipeline.offer({ frame, video });
  }

  // Reports that another view should be shown. The server may have sent that view's frame before it
  // reported the change.
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

  // Switches between the session's view and the own view, whose frames have separate sequence
  // numbers. Drops waiting frames of the old view.
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

  // Reports a frame that could not be decoded. For video there is no notice, because the server
  // continues with JPEG.
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
  const isAvif = frame.avif.byteLength > 0;
  // The cast is safe because decoded messages never use shared buffers, which Blob does not accept.
  const bytes = (isAvif ? frame.avif : frame.jpeg) as Uint8Array<ArrayBuffer>;
  return createImageBitmap(new Blob([bytes], { type: isAvif ? "image/avif" : "image/jpeg" }));
}
