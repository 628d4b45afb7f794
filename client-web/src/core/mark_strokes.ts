// Splits a mark, which people draw over the picture, into strokes that are either hand-drawn ink or
// straight lines. The window and saved files draw the same strokes.
import { getStroke } from "perfect-freehand";
import { parted } from "./lettering";
import { type PicturePoint, type Projection, projectLine, type Vec3 } from "./projection";
import type { StrokePoint } from "./stroke";

export interface MarkStroke {
  // True for a hand-drawn line, which varies in width like ink. Arrows and letters consist of
  // straight strokes.
  readonly ink: boolean;
  readonly points: readonly PicturePoint[];
}

// A mark of a single stroke with more corners than this was drawn by hand.
const MAX_STRAIGHT_CORNERS = 4;
const INK_PX = 6;

export function markStrokes(projection: Projection, pointsM: readonly Vec3[]): MarkStroke[] {
  const strokes = projectLine(projection, pointsM).flatMap((part) => parted(part, samePoint));
  const ink = strokes.length === 1 && (strokes[0]?.length ?? 0) > MAX_STRAIGHT_CORNERS;
  return strokes.map((points) => ({ ink, points }));
}

// Returns the outline of an ink stroke. `scale` multiplies the stroke's width. It is 1 on the page,
// and depends on the picture's size in a saved picture.
export function inkOutline(places: readonly StrokePoint[], scale = 1): [number, number][] {
  const outline = getStroke(
    places.map(({ left, top }) => [left, top]),
    { size: INK_PX * scale, thinning: 0.35, smoothing: 0.6, streamline: 0.2 },
  );
  return outline.map(([x = 0, y = 0]) => [x, y]);
}

function samePoint(a: PicturePoint, b: PicturePoint): boolean {
  return Math.abs(a.x - b.x) < 1e-6 && Math.abs(a.y - b.y) < 1e-6;
}
