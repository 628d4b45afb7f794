// The place that a click on the picture found, and its displacement to the place of the next click.
import type { ProbeRayResponse, RayPlace } from "../gen/thunderhead/v1/probe_pb";
import type { WorldRay } from "./projection";

export interface Probed {
  // The picture that was clicked. In a comparison, B is the picture that is compared with A.
  readonly picture: "A" | "B";
  readonly stormId: string;
  readonly ray: WorldRay;
  readonly found: ProbeRayResponse;
}

// The displacement from one place to another.
export interface Displacement {
  // Distance along the ground.
  readonly distanceM: number;
  readonly heightM: number;
  // Azimuth clockwise from north.
  readonly azimuthDeg: number;
}

export function displacementBetween(
  from: RayPlace | undefined,
  to: RayPlace | undefined,
): Displacement | undefined {
  if (from?.position === undefined || to?.position === undefined) return undefined;
  const [x, y, z] = (["xM", "yM", "zM"] as const).map(
    (axis) => (to.position?.[axis] ?? 0) - (from.position?.[axis] ?? 0),
  ) as [number, number, number];
  return {
    distanceM: Math.hypot(x, y),
    heightM: z,
    azimuthDeg: ((Math.atan2(x, y) * 180) / Math.PI + 360) % 360,
  };
}

// Returns the display unit of a mixing ratio, a mass or an extinction.
export function readable(units: string): { readonly factor: number; readonly symbol: string } {
  switch (units) {
    case "kg kg-1":
      return { factor: 1000, symbol: "g/kg" };
    case "kg m-3":
      return { factor: 1000, symbol: "g/m³" };
    default:
      return { factor: 1000, symbol: "/km" };
  }
}

// Returns a text like "35.21° N 97.44° W".
export function placeInWords(latitudeDeg: number, longitudeDeg: number): string {
  const part = (deg: number, positive: string, negative: string) =>
    `${Math.abs(deg).toFixed(2)}° ${deg < 0 ? negative : positive}`;
  return `${part(latitudeDeg, "N", "S")} ${part(longitudeDeg, "E", "W")}`;
}
