// Test support: a camera's view as the server puts it into a frame, and the point that a ray of the
// view hits.

import type { MessageInitShape } from "@bufbuild/protobuf";
import { poseOfCamera } from "../src/core/camera";
import type { ViewSchema } from "../src/gen/thunderhead/v1/frame_pb";
import type { Ray } from "../src/gen/thunderhead/v1/interact_pb";
import type { Camera } from "../src/gen/thunderhead/v1/scene_pb";

const OTHER_DISTANCE_M = 30_000;

type Triple = readonly [number, number, number];

const vector = ([x, y, z]: Triple, by = 1) => ({ x: x * by, y: y * by, z: z * by });

export function viewOfCamera(
  camera: Camera | undefined,
  aspect: number,
): MessageInitShape<typeof ViewSchema> | undefined {
  const pose = poseOfCamera(camera);
  if (pose?.kind === "topDown") {
    const half = pose.widthM / 2;
    return {
      eye: { xM: pose.centerM[0], yM: pose.centerM[1], zM: 50_000 },
      forward: vector([0, 0, -1]),
      right: vector([half, 0, 0]),
      up: vector([0, half / aspect, 0]),
      parallel: true,
    };
  }
  if (pose?.kind !== "orbit") return undefined;
  const azimuth = (pose.azimuthDeg * Math.PI) / 180;
  const elevation = (pose.elevationDeg * Math.PI) / 180;
  const away: Triple = [
    Math.sin(azimuth) * Math.cos(elevation),
    Math.cos(azimuth) * Math.cos(elevation),
    Math.sin(elevation),
  ];
  const up: Triple = [
    -Math.sin(azimuth) * Math.sin(elevation),
    -Math.cos(azimuth) * Math.sin(elevation),
    Math.cos(elevation),
  ];
  const [x, y, z] = pose.targetM;
  const halfHeight = Math.tan((pose.fieldOfViewDeg * Math.PI) / 360);
  return {
    eye: {
      xM: x + away[0] * pose.distanceM,
      yM: y + away[1] * pose.distanceM,
      zM: z + away[2] * pose.distanceM,
    },
    forward: vector(away, -1),
    right: vector([-Math.cos(azimuth), Math.sin(azimuth), 0], halfHeight * aspect),
    up: vector(up, halfHeight),
    parallel: false,
  };
}

// Returns the point on the plane through the camera's target, which replaces the storm.
export function placeMet(ray: Ray, camera: Camera | undefined) {
  const pose = poseOfCamera(camera);
  const distanceM = pose?.kind === "orbit" ? pose.distanceM : OTHER_DISTANCE_M;
  const { origin, direction } = ray;
  return {
    xM: (origin?.xM ?? 0) + (direction?.x ?? 0) * distanceM,
    yM: (origin?.yM ?? 0) + (direction?.y ?? 0) * distanceM,
    zM: (origin?.zM ?? 0) + (direction?.z ?? 0) * distanceM,
  };
}
