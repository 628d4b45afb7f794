// Draws marks into a picture that is saved. Relative to the picture, they are as large as in a
// window.
import { LETTER_PX, letterPxOf } from "../core/annotations";
import { hexOfColor } from "../core/color";
import { inkOutline, markStrokes } from "../core/mark_strokes";
import { placeInBox } from "../core/picture_box";
import type { Projection } from "../core/projection";
import type { StrokePoint } from "../core/stroke";
import type { Mark } from "../gen/thunderhead/v1/interact_pb";

type Context = CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D;

// Colour and width of the marks' dark edge. picture.css has the same values.
const EDGE = "rgb(0 0 0 / 45%)";
const EDGE_PX = 5;
const LINE_PX = 2.5;
const USUAL_COLOR = "#ffd166";

export function drawMarks(
  context: Context,
  marks: readonly Mark[],
  projection: Projection,
  { width, height }: { readonly width: number; readonly height: number },
): void {
  const scale = letterPxOf(width, height) / LETTER_PX;
  const box = { left: 0, top: 0, width, height };
  context.lineCap = "round";
  context.lineJoin = "round";
  for (const { positions, color } of marks) {
    const paint = color === undefined ? USUAL_COLOR : hexOfColor(color);
    const pointsM = positions.map(({ xM, yM, zM }) => [xM, yM, zM] as const);
    for (const { ink, points } of markStrokes(projection, pointsM)) {
      const places = points.map((point) => placeInBox(box, point));
      (ink ? drawInk : drawLine)(context, places, paint, scale);
    }
  }
}

function drawInk(context: Context, places: readonly StrokePoint[], paint: string, scale: number) {
  context.beginPath();
  for (const [x, y] of inkOutline(places, scale)) context.lineTo(x, y);
  context.closePath();
  context.fillStyle = paint;
  context.fill();
  context.strokeStyle = EDGE;
  context.lineWidth = scale;
  context.stroke();
}

function drawLine(context: Context, places: readonly StrokePoint[], paint: string, scale: number) {
  context.beginPath();
  for (const { left, top } of places) context.lineTo(left, top);
  context.strokeStyle = EDGE;
  context.lineWidth = EDGE_PX * scale;
  context.stroke();
  context.strokeStyle = paint;
  context.lineWidth = LINE_PX * scale;
  context.stroke();
}
