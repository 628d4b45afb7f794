// The pictures of a movie. They show the storm's times one after another, from the present camera
// or along the named views.

import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import { cameraOfPose, type Pose, poseOfCamera } from "./camera";
import type { NamedView } from "./named_views";
import { outputSize, withCamera, withOutput, withTime } from "./scene";

export interface MovieDraft {
  readonly from: number;
  readonly to: number;
  readonly picturesPerSecond: number;
  // Number of pictures from one named view to the next. Used only if `alongViews` is true.
  readonly picturesPerView: number;
  readonly alongViews: boolean;
  readonly widthPx: number;
  readonly heightPx: number;
  readonly format: "webm" | "mp4";
}

export function movieScenes(scene: Scene, draft: MovieDraft, views: readonly NamedView[]): Scene[] {
  const size = outputSize(draft.widthPx, draft.heightPx, 1);
  const one = withOutput(scene, size);
  if (!draft.alongViews) return timesOf(draft).map((time) => withTime(one, time));
  return cameraPath(views, draft.picturesPerView).map(({ pose, timeIndex }) =>
    withTime(withCamera(one, cameraOfPose(pose)), timeIndex),
  );
}

export function pictureCount(
  draft: Pick<MovieDraft, "from" | "to" | "alongViews" | "picturesPerView">,
  views: readonly NamedView[],
): number {
  if (draft.alongViews) return cameraPath(views, draft.picturesPerView).length;
  return timesOf(draft).length;
}

function timesOf({ from, to }: Pick<MovieDraft, "from" | "to">): number[] {
  return Array.from(
    { length: Math.abs(to - from) + 1 },
    (_, at) => from + Math.sign(to - from) * at,
  );
}

interface PathPoint {
  readonly pose: Pose;
  readonly timeIndex: number;
}

// Returns a camera path from view to view. The camera accelerates after each view and slows down
// before the next. Between views with different kinds of cameras the movie cuts instead.
export function cameraPath(views: readonly NamedView[], perView: number): PathPoint[] {
  const stops = views.flatMap(({ camera, timeIndex }) => {
    const pose = poseOfCamera(camera);
    return pose === undefined ? [] : [{ pose, timeIndex }];
  });
  return stops.flatMap((stop, at) => {
    const next = stops[at + 1];
    if (next === undefined) return [stop];
    return Array.from({ length: perView }, (_, picture): PathPoint => {
      const share = smooth(picture / perView);
      const timeIndex = Math.round(stop.timeIndex + share * (next.timeIndex - stop.timeIndex));
      return { pose: poseBetween(stop.pose, next.pose, share), timeIndex };
    });
  });
}

function smooth(share: number): number {
  return share * share * (3 - 2 * share);
}

const ANGLES = new Set(["azimuthDeg"]);

function poseBetween(from: Pose, to: Pose, share: number): Pose {
  if (from.kind !== to.kind) return from;
  const other = to as unknown as Record<string, unknown>;
  const mixed = Object.entries(from).map(([key, value]) => [
    key,
    mix(value, other[key], share, ANGLES.has(key)),
  ]);
  return Object.fromEntries(mixed) as Pose;
}

function mix(from: unknown, to: unknown, share: number, isAngle: boolean): unknown {
  if (Array.isArray(from))
    return from.map((each, at) => mix(each, (to as unknown[])[at], share, false));
  if (typeof from !== "number" || typeof to !== "number") return from;
  // An angle changes along the shorter arc.
  const change = isAngle ? ((((to - from) % 360) + 540) % 360) - 180 : to - from;
  return from + share * change;
}
