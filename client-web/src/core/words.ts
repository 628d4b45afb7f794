// Describes a view as text: the position of the camera and of the sun. The azimuths of a scene
// count from the grid's north, and those of the texts from true north, whose direction in the scene
// is `trueNorthDeg`.
import { type Pose, wrapDegrees } from "./camera";
import { azimuthTo } from "./map_frame";
import { compassPoint, type SunDirection, trueAzimuthDeg } from "./sun";
import { formatLength, formatNumber } from "./units";

export function describePose(pose: Pose | undefined, trueNorthDeg: number): string {
  switch (pose?.kind) {
    case "orbit":
      return (
        `Seen from ${directionInWords(pose.azimuthDeg, trueNorthDeg)}, ` +
        `${Math.round(pose.elevationDeg)}° high, ${formatLength(pose.distanceM, "distance")} away`
      );
    case "spotter":
      return (
        `Looks to ${directionInWords(pose.azimuthDeg, trueNorthDeg)}, ` +
        `${Math.round(pose.elevationDeg)}° up, through a lens of ${formatNumber(pose.focalLengthMm)} mm, ` +
        `from ${placeInDomain(pose.placeM, trueNorthDeg)}`
      );
    case "topDown":
      return `${formatLength(pose.widthM, "distance")} from left to right, ${upInWords(trueNorthDeg)} up`;
    default:
      return "Waiting for the first picture …";
  }
}

// A position whose distance from the domain's middle is below this has no meaningful direction.
const NEAR_MIDDLE_M = 100;

// Returns a text like "20 km SE of the middle". The middle is the origin of the world.
function placeInDomain(placeM: readonly [number, number], trueNorthDeg: number): string {
  const distanceM = Math.hypot(...placeM);
  if (distanceM < NEAR_MIDDLE_M) return "the middle";
  const direction = compassPoint(trueAzimuthDeg(azimuthTo([0, 0], placeM), trueNorthDeg));
  return `${formatLength(distanceM, "distance")} ${direction} of the middle`;
}

export function describeSun(
  { azimuthDeg, elevationDeg }: SunDirection,
  trueNorthDeg: number,
): string {
  const height = Math.round(Math.abs(elevationDeg));
  const where = elevationDeg < 0 ? `${height}° below the horizon` : `${height}° high`;
  return `The sun is in ${compassPoint(trueAzimuthDeg(azimuthDeg, trueNorthDeg))}, ${where}`;
}

// Returns a text like "SSW (200°)".
function directionInWords(azimuthDeg: number, trueNorthDeg: number): string {
  const trueDeg = trueAzimuthDeg(azimuthDeg, trueNorthDeg);
  return `${compassPoint(trueDeg)} (${Math.round(wrapDegrees(trueDeg)) % 360}°)`;
}

// On most maps true north is not exactly up. The text mentions only a difference of half a degree
// or more.
function upInWords(trueNorthDeg: number): string {
  return Math.abs(trueNorthDeg) < 0.5 ? "north" : "the grid's north";
}
