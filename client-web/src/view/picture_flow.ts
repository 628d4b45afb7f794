// Frames on their way to the canvas: of the session's view, or of the own view of a person who looks around. Every frame is
// acknowledged, shown or not: the server sends no third one before.

import { FramePipeline } from "../core/frame_pipeline";
import type { Frame } from "../gen/thunderhead/v1/frame_pb";
import { CanvasPainter } from "./canvas_painter";

export interface PictureFlowSteps {
  acknowledge(sequence: bigint, ownView: boolean): void;
  // True while frames of the own view are to be shown.
  wantsOwnView(): boolean;
  painted(frame: Frame): void;
  undecodable(frame: Frame): void;
  onNextPaint(callback: () => void): () => void;
}

export class PictureFlow {
  readonly #steps: PictureFlowSteps;
  readonly #pipeline: FramePipeline<Frame, ImageBitmap>;
  #painter: CanvasPainter | undefined;
  #showsOwnView = false;
  #newestSequence: bigint | undefined;
  // The newest frame of the session's view that came while the own one was shown.
  #unwanted: Frame | undefined;

  constructor(steps: PictureFlowSteps) {
    this.#steps = steps;
    this.#pipeline = new FramePipeline({
      decode: (frame) => decodeJpeg(frame.jpeg),
      onNextPaint: (callback) => steps.onNextPaint(callback),
      paint: (frame, picture) => this.#paint(frame, picture),
      release: (picture) => picture.close(),
      failed: (frame) => this.#undecodable(frame),
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
    this.#pipeline.startStream();
    this.#newestSequence = undefined;
    this.#unwanted = undefined;
  }

  offer(frame: Frame): void {
    if (frame.ownView !== this.#steps.wantsOwnView()) {
      this.#steps.acknowledge(frame.sequence, frame.ownView);
      if (!frame.ownView) this.#unwanted = frame;
      return;
    }
    if (frame.ownView !== this.#showsOwnView) this.#switchTo(frame.ownView);
    this.#newestSequence = frame.sequence;
    this.#pipeline.offer(frame);
  }

  // Another view is wanted now. The server may have sent its frame before it said so.
  viewChanged(): void {
    const frame = this.#unwanted;
    this.#unwanted = undefined;
    if (frame !== undefined && !this.#steps.wantsOwnView()) this.offer(frame);
  }

  dispose(): void {
    this.#pipeline.dispose();
    this.detach();
  }

  // The views count their sequences apart. What waits of the other is not shown any more.
  #switchTo(ownView: boolean): void {
    if (this.#newestSequence !== undefined)
      this.#steps.acknowledge(this.#newestSequence, this.#showsOwnView);
    this.startCall();
    this.#showsOwnView = ownView;
  }

  #paint(frame: Frame, picture: ImageBitmap): void {
    if (this.#painter === undefined) {
      picture.close();
      return;
    }
    this.#painter.paint(picture);
    this.#steps.acknowledge(frame.sequence, frame.ownView);
    this.#steps.painted(frame);
  }

  #undecodable(frame: Frame): void {
    this.#steps.acknowledge(frame.sequence, frame.ownView);
    this.#steps.undecodable(frame);
  }
}

function decodeJpeg(jpeg: Uint8Array): Promise<ImageBitmap> {
  // Blob does not accept shared buffers; decoded messages never use them.
  const bytes = jpeg as Uint8Array<ArrayBuffer>;
  return createImageBitmap(new Blob([bytes], { type: "image/jpeg" }));
}
