// The result of a probe: the place in the storm at which a person clicked, and the displacement
// from one such place to the next.
import type { ProbeRayResponse, RayPlace } from "../gen/thunderhead/v1/probe_pb";
import type { WorldRay } from "./projection";

export interface Probed {
  // The picture that was clicked. In a comparison, A shows the session and B is the second picture.
  readonly picture: "A" | "B";
  readonly stormId: string;
  readonly ray: WorldRay;
  readonly found: ProbeRayResponse;
}

// The displacement from one place to another.
export interface Displacement {
  // Horizontal distance.
  readonly distanceM: number;
  readonly heightM: number;
  // Azimuth clockwise from the grid's north.
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

// Returns the unit in which a field with these `units` (a mixing ratio, a mass per volume or an
// extinction) is shown.
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
