// Computes the size of a canvas in physical pixels, and the rectangle of a picture on the canvas.
import type { Box } from "../core/picture_box";
import { pictureBox } from "../core/picture_box";

export interface PixelSize {
  readonly widthPx: number;
  readonly heightPx: number;
}

// Returns the canvas's size in physical pixels. The window has `ratio` physical pixels per CSS
// pixel.
export function pixelsOf(canvas: HTMLCanvasElement, ratio: number): PixelSize {
  return {
    widthPx: Math.max(1, Math.round(canvas.clientWidth * ratio)),
    heightPx: Math.max(1, Math.round(canvas.clientHeight * ratio)),
  };
}

// Returns the rectangle of a picture on the canvas, in CSS pixels of the window.
export function boxOnCanvas(canvas: HTMLCanvasElement, picture: PixelSize): Box {
  const { left, top, width, height } = canvas.getBoundingClientRect();
  const box = pictureBox({ width, height }, { width: picture.widthPx, height: picture.heightPx });
  return { ...box, left: left + box.left, top: top + box.top };
}
