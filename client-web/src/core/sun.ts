// The sky dome: the sun's direction as a point in a disc with the zenith at its centre and north at
// its top.
import { wrapDegrees } from "./camera";

export interface SunDirection {
  readonly azimuthDeg: number;
  readonly elevationDeg: number;
}

// End of civil twilight. If the sun is lower, pictures are nearly black.
export const NIGHT_BELOW_DEG = -6;

// Returns a sun direction that lights the side of the storm that the camera sees. The argument is
// the azimuth of the camera's position, seen from the storm. The sun is behind the camera's left
// shoulder.
export function daylight(standingAzimuthDeg: number): SunDirection {
  return { azimuthDeg: (standingAzimuthDeg + 45) % 360, elevationDeg: 35 };
}

// Elevation of the sun at the disc's edge. The edge lies below the horizon so that twilight can be
// set by dragging.
export const DOME_LOWEST_DEG = -18;

// Radius of the horizon, where 1 is the disc's edge.
export const DOME_HORIZON = 90 / (90 - DOME_LOWEST_DEG);

// Returns the offset from the centre, in radii of the disc.
export function domePointOfSun(sun: SunDirection): { right: number; down: number } {
  const elevation = Math.max(DOME_LOWEST_DEG, sun.elevationDeg);
  const radius = (90 - elevation) / (90 - DOME_LOWEST_DEG);
  const azimuth = (sun.azimuthDeg * Math.PI) / 180;
  return { right: radius * Math.sin(azimuth), down: -radius * Math.cos(azimuth) };
}

export function sunOfDomePoint(right: number, down: number): SunDirection {
  const radius = Math.min(1, Math.hypot(right, down));
  const azimuth = (Math.atan2(right, -down) * 180) / Math.PI;
  return {
    azimuthDeg: azimuth < 0 ? azimuth + 360 : azimuth,
    elevationDeg: 90 - radius * (90 - DOME_LOWEST_DEG),
  };
}

// Converts an azimuth of the scene, which counts from the grid's north, to one from true north.
// `trueNorthDeg` is the direction of true north in the scene. The next function converts back.
export function trueAzimuthDeg(azimuthDeg: number, trueNorthDeg: number): number {
  return trueNorthDeg === 0 ? azimuthDeg : wrapDegrees(azimuthDeg - trueNorthDeg);
}

export function gridAzimuthDeg(azimuthDeg: number, trueNorthDeg: number): number {
  return trueAzimuthDeg(azimuthDeg, -trueNorthDeg);
}

const COMPASS = "N NNE NE ENE E ESE SE SSE S SSW SW WSW W WNW NW NNW".split(" ");

export function compassPoint(azimuthDeg: number): string {
  const points = (((azimuthDeg % 360) + 360) % 360) / (360 / COMPASS.length);
  return COMPASS[Math.round(points) % COMPASS.length] ?? "N";
}

// Converts a date and time of the schema, in UTC, to the value of an input of type datetime-local.
// The next function converts back.
export function inputOfDateTime(dateTime: string): string {
  return /^\d{4}-\d\d-\d\dT\d\d:\d\d(:\d\d)?/.exec(dateTime)?.[0] ?? "";
}

export function dateTimeOfInput(input: string): string {
  if (input === "") return "";
  return input.length === "2013-05-20T20:00".length ? `${input}:00Z` : `${input}Z`;
}
