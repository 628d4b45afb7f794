// Where a canvas lies in the window, and a picture on it.
import type { Box } from "../core/picture_box";
import { pictureBox } from "../core/picture_box";

export interface PixelSize {
  readonly widthPx: number;
  readonly heightPx: number;
}

// The canvas's size in physical pixels, of which the window has `ratio` in each of CSS.
export function pixelsOf(canvas: HTMLCanvasElement, ratio: number): PixelSize {
  return {
    widthPx: Math.max(1, Math.round(canvas.clientWidth * ratio)),
    heightPx: Math.max(1, Math.round(canvas.clientHeight * ratio)),
  };
}

// Where a picture on the canvas lies in the window, in CSS pixels.
export function boxOnCanvas(canvas: HTMLCanvasElement, picture: PixelSize): Box {
  const { left, top, width, height } = canvas.getBoundingClientRect();
  const box = pictureBox({ width, height }, { width: picture.widthPx, height: picture.heightPx });
  return { ...box, left: left + box.left, top: top + box.top };
}
