// The area that the inset map shows, and the conversion between its pixels and world metres. The
// grid's north is up, and azimuths here count from it.
import type { Pose } from "./camera";

export interface Extent {
  readonly westM: number;
  readonly southM: number;
  readonly eastM: number;
  readonly northM: number;
}

export interface MapPlace {
  // Position on the map as fractions of its width and height, from its north-west corner.
  readonly right: number;
  readonly down: number;
}

// Width of the margin around the domain, as a fraction of the domain's size.
const MARGIN = 0.06;
// A camera whose distance from the domain's middle exceeds this number times the domain's size,
// along the x or y axis, is shown at the map's edge.
const FARTHEST = 1.2;

// Returns the domain with a margin. The area includes the camera's position if that is not far from
// the domain. The area is square, so that it does not change its shape abruptly.
export function extentOf(domain: Extent, eye: readonly [number, number] | undefined): Extent {
  const size = Math.max(domain.eastM - domain.westM, domain.northM - domain.southM);
  const inReach =
    eye !== undefined &&
    Math.abs(eye[0] - (domain.westM + domain.eastM) / 2) < FARTHEST * size &&
    Math.abs(eye[1] - (domain.southM + domain.northM) / 2) < FARTHEST * size;
  const [x, y] = inReach && eye !== undefined ? eye : [domain.westM, domain.southM];
  const west = Math.min(domain.westM, x);
  const east = Math.max(domain.eastM, x);
  const south = Math.min(domain.southM, y);
  const north = Math.max(domain.northM, y);
  const half = (0.5 + MARGIN) * Math.max(east - west, north - south);
  const [middleX, middleY] = [(west + east) / 2, (south + north) / 2];
  return {
    westM: middleX - half,
    eastM: middleX + half,
    southM: middleY - half,
    northM: middleY + half,
  };
}

export function placeOnMap(extent: Extent, [xM, yM]: readonly [number, number]): MapPlace {
  return {
    right: (xM - extent.westM) / (extent.eastM - extent.westM),
    down: (extent.northM - yM) / (extent.northM - extent.southM),
  };
}

export function worldOfMap(extent: Extent, { right, down }: MapPlace): [number, number] {
  return [
    extent.westM + right * (extent.eastM - extent.westM),
    extent.northM - down * (extent.northM - extent.southM),
  ];
}

// Returns the camera's position and the azimuth to which it looks; undefined for a camera that
// looks straight down.
export function standOf(
  pose: Pose | undefined,
): { readonly placeM: readonly [number, number]; readonly lookDeg: number } | undefined {
  if (pose?.kind === "spotter") return { placeM: pose.placeM, lookDeg: pose.azimuthDeg };
  if (pose?.kind !== "orbit") return undefined;
  const away = pose.distanceM * Math.cos(radians(pose.elevationDeg));
  const azimuth = radians(pose.azimuthDeg);
  const [x, y] = pose.targetM;
  return {
    placeM: [x + away * Math.sin(azimuth), y + away * Math.cos(azimuth)],
    lookDeg: pose.azimuthDeg + 180,
  };
}

// Returns the place at a distance and an azimuth from another place.
export function placeFrom(
  [xM, yM]: readonly [number, number],
  distanceM: number,
  azimuthDeg: number,
): [number, number] {
  return [
    xM + distanceM * Math.sin(radians(azimuthDeg)),
    yM + distanceM * Math.cos(radians(azimuthDeg)),
  ];
}

// Returns the azimuth from the first place to the second, in degrees clockwise from the grid's
// north.
export function azimuthTo(
  [fromX, fromY]: readonly [number, number],
  [toX, toY]: readonly [number, number],
): number {
  return ((Math.atan2(toX - fromX, toY - fromY) * 180) / Math.PI + 360) % 360;
}

function radians(degrees: number): number {
  return (degrees * Math.PI) / 180;
}
