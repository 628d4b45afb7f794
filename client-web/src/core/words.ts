// Describes a view as text: the position of the camera and of the sun.
import { type Pose, wrapDegrees } from "./camera";
import { azimuthTo } from "./map_frame";
import { compassPoint, type SunDirection } from "./sun";
import { formatLength, formatNumber } from "./units";

export function describePose(pose: Pose | undefined): string {
  switch (pose?.kind) {
    case "orbit":
      return (
        `Seen from ${compassPoint(pose.azimuthDeg)} (${wholeDegrees(pose.azimuthDeg)}°), ` +
        `${Math.round(pose.elevationDeg)}° high, ${formatLength(pose.distanceM, "distance")} away`
      );
    case "spotter":
      return (
        `Looks to ${compassPoint(pose.azimuthDeg)} (${wholeDegrees(pose.azimuthDeg)}°), ` +
        `${Math.round(pose.elevationDeg)}° up, through a lens of ${formatNumber(pose.focalLengthMm)} mm, ` +
        `from ${placeInDomain(pose.placeM)}`
      );
    case "topDown":
      return `${formatLength(pose.widthM, "distance")} from left to right, north up`;
    default:
      return "Waiting for the first picture …";
  }
}

// A position whose distance from the domain's middle is below this has no meaningful direction.
const NEAR_MIDDLE_M = 100;

// Returns a text like "20 km SE of the middle". The middle is the origin of the world.
function placeInDomain(placeM: readonly [number, number]): string {
  const distanceM = Math.hypot(...placeM);
  if (distanceM < NEAR_MIDDLE_M) return "the middle";
  const direction = compassPoint(azimuthTo([0, 0], placeM));
  return `${formatLength(distanceM, "distance")} ${direction} of the middle`;
}

export function describeSun({ azimuthDeg, elevationDeg }: SunDirection): string {
  const height = Math.round(Math.abs(elevationDeg));
  const where = elevationDeg < 0 ? `${height}° below the horizon` : `${height}° high`;
  return `The sun is in ${compassPoint(azimuthDeg)}, ${where}`;
}

function wholeDegrees(azimuthDeg: number): number {
  return Math.round(wrapDegrees(azimuthDeg)) % 360;
}
