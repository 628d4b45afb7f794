// Reduces the corners of a hand-drawn line by the algorithm of Ramer, Douglas and Peucker.

export interface StrokePoint {
  readonly left: number;
  readonly top: number;
}

const FINEST_TOLERANCE_PX = 0.75;
const COARSER = 1.5;
const ENDS = 2;

// Returns at most `most` of the points, but always both ends. The tolerance starts at
// FINEST_TOLERANCE_PX and grows by the factor COARSER until few enough points are left.
export function simplifiedStroke<P extends StrokePoint>(points: readonly P[], most: number): P[] {
  for (let tolerancePx = FINEST_TOLERANCE_PX; ; tolerancePx *= COARSER) {
    const kept = withinTolerance(points, tolerancePx);
    if (kept.length <= Math.max(most, ENDS)) return kept;
  }
}

export function strokeLengthPx(points: readonly StrokePoint[]): number {
  let length = 0;
  for (let i = 1; i < points.length; i += 1) {
    const [a, b] = [points[i - 1], points[i]];
    if (a !== undefined && b !== undefined) length += Math.hypot(b.left - a.left, b.top - a.top);
  }
  return length;
}

function withinTolerance<P extends StrokePoint>(points: readonly P[], tolerancePx: number): P[] {
  const kept = new Set([0, points.length - 1]);
  const open: [number, number][] = [[0, points.length - 1]];
  for (let range = open.pop(); range !== undefined; range = open.pop()) {
    const [first, last] = range;
    const farthest = farthestFromLine(points, first, last);
    if (farthest.distancePx <= tolerancePx) continue;
    kept.add(farthest.at);
    open.push([first, farthest.at], [farthest.at, last]);
  }
  return points.filter((_, at) => kept.has(at));
}

function farthestFromLine(points: readonly StrokePoint[], first: number, last: number) {
  let farthest = { at: first, distancePx: 0 };
  const [from, to] = [points[first], points[last]];
  if (from === undefined || to === undefined) return farthest;
  for (let at = first + 1; at < last; at += 1) {
    const point = points[at];
    if (point === undefined) continue;
    const distancePx = distanceFromSegment(point, from, to);
    if (distancePx > farthest.distancePx) farthest = { at, distancePx };
  }
  return farthest;
}

function distanceFromSegment(point: StrokePoint, from: StrokePoint, to: StrokePoint): number {
  const [right, down] = [to.left - from.left, to.top - from.top];
  const squared = right * right + down * down;
  const along =
    squared === 0
      ? 0
      : ((point.left - from.left) * right + (point.top - from.top) * down) / squared;
  const share = Math.min(1, Math.max(0, along));
  return Math.hypot(
    point.left - (from.left + share * right),
    point.top - (from.top + share * down),
  );
}
