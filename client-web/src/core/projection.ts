// Projects world points into a picture, and returns the rays through its points. The projection
// uses Frame.view, the camera of the shown frame. Picture coordinates: x is -1 at the left edge and
// 1 at the right edge; y is -1 at the bottom and 1 at the top.
import type { Vector, View } from "../gen/thunderhead/v1/frame_pb";

export type Vec3 = readonly [number, number, number];

export interface Projection {
  readonly eyeM: Vec3;
  readonly forward: Vec3;
  readonly right: Vec3;
  readonly up: Vec3;
  readonly parallel: boolean;
}

export interface PicturePoint {
  readonly x: number;
  readonly y: number;
}

export interface WorldRay {
  readonly originM: Vec3;
  readonly direction: Vec3;
}

// Minimum depth in front of a perspective camera. Nearer points have no position in the picture.
const NEAR_M = 1;

// Returns the projection of a view; undefined if the view is incomplete.
export function projectionOf(view: View | undefined): Projection | undefined {
  const { eye, forward, right, up, parallel } = view ?? {};
  if (eye === undefined || !hasLength(forward) || !hasLength(right) || !hasLength(up))
    return undefined;
  return {
    eyeM: [eye.xM, eye.yM, eye.zM],
    forward: [forward.x, forward.y, forward.z],
    right: [right.x, right.y, right.z],
    up: [up.x, up.y, up.z],
    parallel: parallel ?? false,
  };
}

function hasLength(vector: Vector | undefined): vector is Vector {
  return vector !== undefined && (vector.x !== 0 || vector.y !== 0 || vector.z !== 0);
}

export function rayAt(projection: Projection, { x, y }: PicturePoint): WorldRay {
  const { eyeM, forward, right, up, parallel } = projection;
  const aside = add(scaled(right, x), scaled(up, y));
  if (parallel) return { originM: add(eyeM, aside), direction: forward };
  return { originM: eyeM, direction: add(forward, aside) };
}

export function pointOnRay({ originM, direction }: WorldRay, times: number): Vec3 {
  return add(originM, scaled(direction, times));
}

// Returns a point's position in the picture. Returns undefined for a point that is behind a
// perspective camera, or less than NEAR_M in front of it.
export function project(projection: Projection, pointM: Vec3): PicturePoint | undefined {
  const depthM = depthOf(projection, pointM);
  if (!projection.parallel && depthM < NEAR_M) return undefined;
  return place(projection, pointM, depthM);
}

// Returns the parts of a line that are in front of the camera. In a parallel projection this is the
// whole line.
export function projectLine(projection: Projection, pointsM: readonly Vec3[]): PicturePoint[][] {
  if (pointsM.length === 0) return [];
  if (projection.parallel) return [pointsM.map((point) => place(projection, point, 1))];
  const parts: PicturePoint[][] = [];
  let part: PicturePoint[] = [];
  let before: { pointM: Vec3; depthM: number } | undefined;
  for (const pointM of pointsM) {
    const depthM = depthOf(projection, pointM);
    const visible = depthM >= NEAR_M;
    if (before !== undefined && visible !== before.depthM >= NEAR_M) {
      const share = (NEAR_M - before.depthM) / (depthM - before.depthM);
      const cut = add(scaled(before.pointM, 1 - share), scaled(pointM, share));
      part.push(place(projection, cut, NEAR_M));
    }
    if (visible) part.push(place(projection, pointM, depthM));
    else if (part.length > 0) {
      parts.push(part);
      part = [];
    }
    before = { pointM, depthM };
  }
  if (part.length > 0) parts.push(part);
  return parts;
}

function depthOf({ eyeM, forward }: Projection, pointM: Vec3): number {
  return dot(minus(pointM, eyeM), forward);
}

// Right and up are perpendicular to each other and to forward, so x and y are computed separately.
function place(projection: Projection, pointM: Vec3, depthM: number): PicturePoint {
  const { eyeM, right, up, parallel } = projection;
  const fromEye = minus(pointM, eyeM);
  const reach = parallel ? 1 : depthM;
  return {
    x: dot(fromEye, right) / (dot(right, right) * reach),
    y: dot(fromEye, up) / (dot(up, up) * reach),
  };
}

function add(a: Vec3, b: Vec3): Vec3 {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

function minus(a: Vec3, b: Vec3): Vec3 {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

function scaled(a: Vec3, by: number): Vec3 {
  return [a[0] * by, a[1] * by, a[2] * by];
}

function dot(a: Vec3, b: Vec3): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
