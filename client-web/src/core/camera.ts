// Camera motions: how a drag in pixels moves and turns each kind of camera. The world axes are
// those of proto/thunderhead/v1/scene.proto. The x axis points to the grid's east, y to its north
// and z up; the azimuth is clockwise from the grid's north.
import { create } from "@bufbuild/protobuf";
import {
  type Camera,
  CameraSchema,
  OrbitCameraSchema,
  PositionSchema,
  SpotterCameraSchema,
  TopDownCameraSchema,
} from "../gen/thunderhead/v1/scene_pb";
import { clampToLimits, defaultNumberOf, type Limits, limitsOf } from "./limits";

export interface OrbitPose {
  readonly kind: "orbit";
  readonly targetM: readonly [number, number, number];
  readonly azimuthDeg: number;
  readonly elevationDeg: number;
  readonly distanceM: number;
  readonly fieldOfViewDeg: number;
}

// A camera that stands on the ground and looks to an azimuth and an elevation.
export interface SpotterPose {
  readonly kind: "spotter";
  readonly placeM: readonly [number, number];
  readonly eyeHeightM: number;
  readonly azimuthDeg: number;
  readonly elevationDeg: number;
  readonly focalLengthMm: number;
}

// A camera that looks straight down, with north up.
export interface TopDownPose {
  readonly kind: "topDown";
  readonly centerM: readonly [number, number];
  readonly widthM: number;
}

// The picture's size, in the unit of the pointer's motions.
export interface PictureSize {
  readonly widthPx: number;
  readonly heightPx: number;
}

export type Pose = OrbitPose | SpotterPose | TopDownPose;
export type CameraKind = Pose["kind"];

export const SPOTTER_LIMITS = {
  x: limitsOf(SpotterCameraSchema.field.xM),
  y: limitsOf(SpotterCameraSchema.field.yM),
  eyeHeight: limitsOf(SpotterCameraSchema.field.eyeHeightM),
  azimuth: limitsOf(SpotterCameraSchema.field.azimuthDeg),
  elevation: limitsOf(SpotterCameraSchema.field.elevationDeg),
  focalLength: limitsOf(SpotterCameraSchema.field.focalLengthMm),
} as const satisfies Record<string, Limits>;

export const TOP_DOWN_LIMITS = {
  x: limitsOf(TopDownCameraSchema.field.xM),
  y: limitsOf(TopDownCameraSchema.field.yM),
  width: limitsOf(TopDownCameraSchema.field.widthM),
} as const satisfies Record<string, Limits>;

const AZIMUTH = limitsOf(OrbitCameraSchema.field.azimuthDeg);
const ELEVATION = limitsOf(OrbitCameraSchema.field.elevationDeg);
const DISTANCE = limitsOf(OrbitCameraSchema.field.distanceM);
const FIELD_OF_VIEW = limitsOf(OrbitCameraSchema.field.fieldOfViewDeg);
const TARGET_X = limitsOf(PositionSchema.field.xM);
const TARGET_Y = limitsOf(PositionSchema.field.yM);
const TARGET_Z = limitsOf(PositionSchema.field.zM);

// Angle by which a drag across the picture's whole height turns the camera.
const DEGREES_PER_HEIGHT = 180;

// Distance that a spotter walks for a drag across the picture's whole height.
const WALK_PER_HEIGHT_M = 20_000;

// Height of the film frame of 36 x 24 mm to which a spotter's focal length refers.
const FRAME_HEIGHT_MM = 24;

// Returns the pose of a camera whose values the server has filled in; undefined while some are
// missing.
export function poseOfCamera(camera: Camera | undefined): Pose | undefined {
  switch (camera?.kind.case) {
    case "orbit": {
      const { target, azimuthDeg, elevationDeg, distanceM, fieldOfViewDeg } = camera.kind.value;
      if (target === undefined || elevationDeg === undefined || distanceM === undefined)
        return undefined;
      return {
        kind: "orbit",
        targetM: [target.xM, target.yM, target.zM],
        azimuthDeg: azimuthDeg ?? defaultNumberOf(AZIMUTH),
        elevationDeg,
        distanceM,
        fieldOfViewDeg: fieldOfViewDeg ?? defaultNumberOf(FIELD_OF_VIEW),
      };
    }
    case "spotter": {
      const { xM, yM, eyeHeightM, azimuthDeg, elevationDeg, focalLengthMm } = camera.kind.value;
      if (xM === undefined || yM === undefined) return undefined;
      if (azimuthDeg === undefined || elevationDeg === undefined) return undefined;
      return {
        kind: "spotter",
        placeM: [xM, yM],
        eyeHeightM: eyeHeightM ?? defaultNumberOf(SPOTTER_LIMITS.eyeHeight),
        azimuthDeg,
        elevationDeg,
        focalLengthMm: focalLengthMm ?? defaultNumberOf(SPOTTER_LIMITS.focalLength),
      };
    }
    case "topDown": {
      const { xM, yM, widthM } = camera.kind.value;
      if (xM === undefined || yM === undefined || widthM === undefined) return undefined;
      return { kind: "topDown", centerM: [xM, yM], widthM };
    }
    default:
      return undefined;
  }
}

export function cameraOfPose(pose: Pose): Camera {
  switch (pose.kind) {
    case "orbit":
      return create(CameraSchema, { kind: { case: "orbit", value: orbitMessage(pose) } });
    case "spotter":
      return create(CameraSchema, { kind: { case: "spotter", value: spotterMessage(pose) } });
    case "topDown": {
      const value = {
        xM: clampToLimits(pose.centerM[0], TOP_DOWN_LIMITS.x),
        yM: clampToLimits(pose.centerM[1], TOP_DOWN_LIMITS.y),
        widthM: clampToLimits(pose.widthM, TOP_DOWN_LIMITS.width),
      };
      return create(CameraSchema, { kind: { case: "topDown", value } });
    }
  }
}

function orbitMessage(pose: OrbitPose) {
  const [x, y, z] = pose.targetM;
  return {
    target: {
      xM: clampToLimits(x, TARGET_X),
      yM: clampToLimits(y, TARGET_Y),
      zM: clampToLimits(z, TARGET_Z),
    },
    azimuthDeg: clampToLimits(wrapDegrees(pose.azimuthDeg), AZIMUTH),
    elevationDeg: clampToLimits(pose.elevationDeg, ELEVATION),
    distanceM: clampToLimits(pose.distanceM, DISTANCE),
    fieldOfViewDeg: clampToLimits(pose.fieldOfViewDeg, FIELD_OF_VIEW),
  };
}

function spotterMessage(pose: SpotterPose) {
  return {
    xM: clampToLimits(pose.placeM[0], SPOTTER_LIMITS.x),
    yM: clampToLimits(pose.placeM[1], SPOTTER_LIMITS.y),
    eyeHeightM: clampToLimits(pose.eyeHeightM, SPOTTER_LIMITS.eyeHeight),
    azimuthDeg: clampToLimits(wrapDegrees(pose.azimuthDeg), SPOTTER_LIMITS.azimuth),
    elevationDeg: clampToLimits(pose.elevationDeg, SPOTTER_LIMITS.elevation),
    focalLengthMm: clampToLimits(pose.focalLengthMm, SPOTTER_LIMITS.focalLength),
  };
}

// Returns a camera of that kind with no values set. The server then chooses values that show the
// whole storm.
export function homeCamera(kind: CameraKind = "orbit"): Camera {
  return create(CameraSchema, { kind: { case: kind, value: {} } });
}

// Returns the azimuth of the camera's position, seen from its target; undefined for a camera that
// looks straight down.
export function standingAzimuthDeg(pose: Pose | undefined): number | undefined {
  if (pose?.kind === "orbit") return pose.azimuthDeg;
  return pose?.kind === "spotter" ? wrapDegrees(pose.azimuthDeg + 180) : undefined;
}

// Returns the same azimuth between 0 and 360 degrees.
export function wrapDegrees(degrees: number): number {
  const wrapped = degrees % 360;
  return wrapped < 0 ? wrapped + 360 : wrapped;
}

// Turns or moves the camera so that the scene follows the pointer. An orbit camera turns around its
// target, a spotter turns its head, and a top-down camera moves. Pixel distances are positive to
// the right and down.
export function drag<P extends Pose>(
  pose: P,
  rightPx: number,
  downPx: number,
  picture: PictureSize,
): P;
export function drag(pose: Pose, rightPx: number, downPx: number, picture: PictureSize): Pose {
  const height = Math.max(1, picture.heightPx);
  switch (pose.kind) {
    case "orbit":
      return turn(
        pose,
        (rightPx * DEGREES_PER_HEIGHT) / height,
        (downPx * DEGREES_PER_HEIGHT) / height,
      );
    case "spotter": {
      const degreesPerPixel = degrees(FRAME_HEIGHT_MM / pose.focalLengthMm / height);
      return turn(pose, -rightPx * degreesPerPixel, downPx * degreesPerPixel);
    }
    case "topDown":
      return pan(pose, rightPx, downPx, picture);
  }
}

// Turns an orbit camera around its target, clockwise as seen from above, and up. Turns a spotter's
// head to the right and up. A top-down camera cannot turn.
export function turn<P extends Pose>(pose: P, azimuthDeg: number, elevationDeg: number): P;
export function turn(pose: Pose, azimuthDeg: number, elevationDeg: number): Pose {
  if (pose.kind === "topDown") return pose;
  return {
    ...pose,
    azimuthDeg: wrapDegrees(pose.azimuthDeg + azimuthDeg),
    elevationDeg: clampToLimits(pose.elevationDeg + elevationDeg, ELEVATION),
  };
}

// Moves an orbit camera or a top-down camera perpendicular to the line of sight, so that points at
// the target's distance follow the pointer. A spotter walks instead: to the left for a drag to the
// right, and backwards for a drag up.
export function pan<P extends Pose>(
  pose: P,
  rightPx: number,
  downPx: number,
  picture: PictureSize,
): P;
export function pan(pose: Pose, rightPx: number, downPx: number, picture: PictureSize): Pose {
  const height = Math.max(1, picture.heightPx);
  switch (pose.kind) {
    case "orbit":
      return panOrbit(pose, rightPx, downPx, height);
    case "spotter": {
      const metresPerPixel = WALK_PER_HEIGHT_M / height;
      const azimuth = radians(pose.azimuthDeg);
      const rightM = -rightPx * metresPerPixel;
      const forwardM = downPx * metresPerPixel;
      const [x, y] = pose.placeM;
      return {
        ...pose,
        placeM: [
          x + rightM * Math.cos(azimuth) + forwardM * Math.sin(azimuth),
          y - rightM * Math.sin(azimuth) + forwardM * Math.cos(azimuth),
        ],
      };
    }
    case "topDown": {
      const metresPerPixel = pose.widthM / Math.max(1, picture.widthPx);
      const [x, y] = pose.centerM;
      return { ...pose, centerM: [x - rightPx * metresPerPixel, y + downPx * metresPerPixel] };
    }
  }
}

function panOrbit(pose: OrbitPose, rightPx: number, downPx: number, heightPx: number): OrbitPose {
  const halfAngle = radians(pose.fieldOfViewDeg) / 2;
  const metresPerPixel = (2 * pose.distanceM * Math.tan(halfAngle)) / heightPx;
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

// Zooms in if the factor is below 1. An orbit camera moves nearer, a spotter uses a longer lens,
// and a top-down camera shows a smaller area.
export function zoom<P extends Pose>(pose: P, factor: number): P;
export function zoom(pose: Pose, factor: number): Pose {
  switch (pose.kind) {
    case "orbit":
      return { ...pose, distanceM: clampToLimits(pose.distanceM * factor, DISTANCE) };
    case "spotter":
      return {
        ...pose,
        focalLengthMm: clampToLimits(pose.focalLengthMm / factor, SPOTTER_LIMITS.focalLength),
      };
    case "topDown":
      return { ...pose, widthM: clampToLimits(pose.widthM * factor, TOP_DOWN_LIMITS.width) };
  }
}

// Returns unit vectors of the picture's right and up directions in the world.
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

function degrees(radians: number): number {
  return (radians * 180) / Math.PI;
}
