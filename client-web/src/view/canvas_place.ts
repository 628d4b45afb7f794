// The canvas in the window: its size in physical pixels, and the input on it.
import type { Box } from "../core/picture_box";
import { boxOnCanvas, type PixelSize, pixelsOf } from "./canvas_box";
import type { PictureFlow } from "./picture_flow";
import { attachPointer, type PointerSteps } from "./pointer";

export interface CanvasPlaceSteps extends PointerSteps {
  resized(): void;
  // Reports that the canvas's size has not changed for a while.
  resizeRested(): void;
}

const RESIZE_REST_MS = 150;

export class CanvasPlace {
  readonly #window: Window;
  readonly #flow: PictureFlow;
  readonly #steps: CanvasPlaceSteps;
  #canvas: HTMLCanvasElement | undefined;
  #size: PixelSize = { widthPx: 1280, heightPx: 720 };

  constructor(window: Window, flow: PictureFlow, steps: CanvasPlaceSteps) {
    this.#window = window;
    this.#flow = flow;
    this.#steps = steps;
  }

  get canvas(): HTMLCanvasElement | undefined {
    return this.#canvas;
  }

  // Returns the canvas's size in physical pixels.
  get size(): PixelSize {
    return this.#size;
  }

  // Returns the rectangle of a picture in the window, in CSS pixels.
  boxOf(picture: PixelSize): Box | undefined {
    return this.#canvas === undefined ? undefined : boxOnCanvas(this.#canvas, picture);
  }

  // Attaches the canvas. Returns the function that detaches it.
  attach(canvas: HTMLCanvasElement): () => void {
    const painter = this.#flow.attach(canvas);
    this.#canvas = canvas;
    const detachPointer = attachPointer(canvas, this.#steps);
    let resting: ReturnType<typeof setTimeout> | undefined;
    const measure = () => {
      this.#size = pixelsOf(canvas, this.#window.devicePixelRatio);
      painter.resize(this.#size.widthPx, this.#size.heightPx);
      this.#steps.resized();
    };
    const observer = new ResizeObserver(() => {
      measure();
      clearTimeout(resting);
      resting = setTimeout(() => this.#steps.resizeRested(), RESIZE_REST_MS);
    });
    observer.observe(canvas);
    measure();
    return () => {
      observer.disconnect();
      clearTimeout(resting);
      detachPointer();
      this.#flow.detach();
      this.#canvas = undefined;
    };
  }
}
