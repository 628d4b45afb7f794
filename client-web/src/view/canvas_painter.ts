// Draws the newest picture into a canvas, centred and as large as fits. Draws the picture again
// when the canvas changes size. The painter owns the picture on the screen and must close it.
import { pictureBox } from "../core/picture_box";

// A decoded picture, from an image file or from video.
export type Picture = ImageBitmap | VideoFrame;

function sizeOf(picture: Picture): { width: number; height: number } {
  if ("displayWidth" in picture)
    return { width: picture.displayWidth, height: picture.displayHeight };
  return picture;
}

export class CanvasPainter {
  readonly #canvas: HTMLCanvasElement;
  readonly #context: CanvasRenderingContext2D;
  #picture: Picture | undefined;

  constructor(canvas: HTMLCanvasElement) {
    const context = canvas.getContext("2d", { alpha: false });
    if (context === null) throw new Error("this browser cannot draw on a canvas");
    this.#canvas = canvas;
    this.#context = context;
  }

  // Draws the picture, and takes ownership of it.
  paint(picture: Picture): void {
    this.#picture?.close();
    this.#picture = picture;
    this.#draw();
  }

  resize(widthPx: number, heightPx: number): void {
    if (this.#canvas.width === widthPx && this.#canvas.height === heightPx) return;
    this.#canvas.width = widthPx;
    this.#canvas.height = heightPx;
    this.#draw();
  }

  dispose(): void {
    this.#picture?.close();
    this.#picture = undefined;
  }

  #draw(): void {
    const picture = this.#picture;
    if (picture === undefined) return;
    const { width, height } = this.#canvas;
    const size = sizeOf(picture);
    const box = pictureBox({ width, height }, size);
    const shownWidth = Math.round(box.width);
    const shownHeight = Math.round(box.height);
    const left = Math.floor((width - shownWidth) / 2);
    const top = Math.floor((height - shownHeight) / 2);
    if (shownWidth < width || shownHeight < height) {
      this.#context.fillStyle = "#05070a";
      this.#context.fillRect(0, 0, width, height);
    }
    this.#context.imageSmoothingEnabled = shownWidth !== size.width;
    this.#context.imageSmoothingQuality = "medium";
    this.#context.drawImage(picture, left, top, shownWidth, shownHeight);
  }
}
