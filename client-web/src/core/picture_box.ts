// The rectangle of a picture in a canvas: centred, and as large as fits.
import type { PicturePoint } from "./projection";

export interface Box {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

interface Size {
  readonly width: number;
  readonly height: number;
}

export function pictureBox(canvas: Size, picture: Size): Box {
  const scale = Math.min(canvas.width / picture.width, canvas.height / picture.height);
  const [width, height] = [picture.width * scale, picture.height * scale];
  return {
    left: (canvas.width - width) / 2,
    top: (canvas.height - height) / 2,
    width,
    height,
  };
}

// Converts a position in the window to a point of the picture; undefined outside the picture.
export function picturePointAt(box: Box, left: number, top: number): PicturePoint | undefined {
  const x = (2 * (left - box.left)) / box.width - 1;
  const y = 1 - (2 * (top - box.top)) / box.height;
  return Math.abs(x) <= 1 && Math.abs(y) <= 1 ? { x, y } : undefined;
}

export function placeInBox(box: Box, point: PicturePoint): { left: number; top: number } {
  return {
    left: box.left + ((point.x + 1) / 2) * box.width,
    top: box.top + ((1 - point.y) / 2) * box.height,
  };
}
