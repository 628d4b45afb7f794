// The orbit camera's motions: what a drag of so many pixels does to azimuth, elevation, distance and target.
// World axes as in proto/thunderhead/v1/scene.proto: x east, y north, z up, azimuth clockwise from north.
import { create } from "@bufbuild/protobuf";
import {
  type Camera,
  CameraSchema,
  OrbitCameraSchema,
  PositionSchema,
} from "../gen/thunderhead/v1/scene_pb";
import { clampToLimits, limitsOf } from "./limits";

export interface OrbitPose {
  readonly targetM: readonly [number, number, number];
  readonly azimuthDeg: number;
  readonly elevationDeg: number;
  readonly distanceM: number;
  readonly fieldOfViewDeg: number;
}

const AZIMUTH = limitsOf(OrbitCameraSchema.field.azimuthDeg);
const ELEVATION = limitsOf(OrbitCameraSchema.field.elevationDeg);
const DISTANCE = limitsOf(OrbitCameraSchema.field.distanceM);
const FIELD_OF_VIEW = limitsOf(OrbitCameraSchema.field.fieldOfViewDeg);
const TARGET_X = limitsOf(PositionSchema.field.xM);
const TARGET_Y = limitsOf(PositionSchema.field.yM);
const TARGET_Z = limitsOf(PositionSchema.field.zM);

// Dragging across the whole height of the picture turns the camera this far.
const DEGREES_PER_HEIGHT = 180;

// The pose of a camera in which the server has filled in every value; undefined while some are missing.
export function poseOfCamera(camera: Camera | undefined): OrbitPose | undefined {
  if (camera?.kind.case !== "orbit") return undefined;
  const { target, azimuthDeg, elevationDeg, distanceM, fieldOfViewDeg } = camera.kind.value;
  if (target === undefined || distanceM === undefined) return undefined;
  return {
    targetM: [target.xM, target.yM, target.zM],
    azimuthDeg: azimuthDeg ?? AZIMUTH.defaultValue ?? 0,
    elevationDeg: elevationDeg ?? ELEVATION.defaultValue ?? 0,
    distanceM,
    fieldOfViewDeg: fieldOfViewDeg ?? FIELD_OF_VIEW.defaultValue ?? 35,
  };
}

export function cameraOfPose(pose: OrbitPose): Camera {
  const [x, y, z] = pose.targetM;
  return create(CameraSchema, {
    kind: {
      case: "orbit",
      value: {
        target: {
          xM: clampToLimits(x, TARGET_X),
          yM: clampToLimits(y, TARGET_Y),
          zM: clampToLimits(z, TARGET_Z),
        },
        azimuthDeg: clampToLimits(wrapDegrees(pose.azimuthDeg), AZIMUTH),
        elevationDeg: clampToLimits(pose.elevationDeg, ELEVATION),
        distanceM: clampToLimits(pose.distanceM, DISTANCE),
        fieldOfViewDeg: clampToLimits(pose.fieldOfViewDeg, FIELD_OF_VIEW),
      },
    },
  });
}

// A camera with nothing set: the server frames the whole storm.
export function homeCamera(): Camera {
  return create(CameraSchema, { kind: { case: "orbit", value: {} } });
}

// The same direction between 0 and 360 degrees.
export function wrapDegrees(degrees: number): number {
  const wrapped = degrees % 360;
  return wrapped < 0 ? wrapped + 360 : wrapped;
}

// Turns so that the storm follows the pointer. Pixels are right and down; heightPx is the picture's height.
export function orbit(
  pose: OrbitPose,
  rightPx: number,
  downPx: number,
  heightPx: number,
): OrbitPose {
  const degreesPerPixel = DEGREES_PER_HEIGHT / Math.max(1, heightPx);
  return turn(pose, rightPx * degreesPerPixel, downPx * degreesPerPixel);
}

// Moves the camera around the target: clockwise seen from above, and up.
export function turn(pose: OrbitPose, azimuthDeg: number, elevationDeg: number): OrbitPose {
  return {
    ...pose,
    azimuthDeg: wrapDegrees(pose.azimuthDeg + azimuthDeg),
    elevationDeg: clampToLimits(pose.elevationDeg + elevationDeg, ELEVATION),
  };
}

// Moves the target in the plane of the picture, so that what lies at the target's distance follows the pointer.
export function pan(pose: OrbitPose, rightPx: number, downPx: number, heightPx: number): OrbitPose {
  const halfAngle = radians(pose.fieldOfViewDeg) / 2;
  const metresPerPixel = (2 * pose.distanceM * Math.tan(halfAngle)) / Math.max(1, heightPx);
  const { right, up } = pictureAxes(pose);
  const rightM = -rightPx * metresPerPixel;
  const upM = downPx * metresPerPixel;
  const [x, y, z] = pose.targetM;
  return {
    ...pose,
    targetM: [
      x + right[0] * rightM + up[0] * upM,
      y + right[1] * rightM + up[1] * upM,
      z + right[2] * rightM + up[2] * upM,
    ],
  };
}

// Multiplies the distance; below 1 comes nearer.
export function zoom(pose: OrbitPose, factor: number): OrbitPose {
  return { ...pose, distanceM: clampToLimits(pose.distanceM * factor, DISTANCE) };
}

// Unit vectors of the picture's right and up in the world.
export function pictureAxes(pose: OrbitPose): {
  right: [number, number, number];
  up: [number, number, number];
} {
  const azimuth = radians(pose.azimuthDeg);
  const elevation = radians(pose.elevationDeg);
  return {
    right: [-Math.cos(azimuth), Math.sin(azimuth), 0],
    up: [
      -Math.sin(azimuth) * Math.sin(elevation),
      -Math.cos(azimuth) * Math.sin(elevation),
      Math.cos(elevation),
    ],
  };
}

function radians(degrees: number): number {
  return (degrees * Math.PI) / 180;
}
