// The domain of a storm is the part of the world that its model covers. Runs over the same domain
// share their named views.
import type { StormDescription } from "../gen/thunderhead/v1/storm_pb";
import { secondsBetween } from "./moment";

type Placed = Pick<StormDescription, "grid" | "latitudeDeg" | "longitudeDeg">;

// Returns a text that identifies the storm's domain; an empty text if the storm is unknown. Storms
// of the same domain have the same text. Heights are ignored because the heights of a model's
// layers may differ between runs.
export function domainOf(storm: Placed | undefined): string {
  const grid = storm?.grid;
  if (storm === undefined || grid === undefined) return "";
  const { nx, ny, dxM, dyM, low } = grid;
  // Degrees are compared to five decimals, which is about a metre.
  const place = [storm.latitudeDeg, storm.longitudeDeg].map((degrees) => degrees?.toFixed(5) ?? "");
  const lengths = [dxM, dyM, low?.xM ?? 0, low?.yM ?? 0].map((metres) => metres.toFixed(1));
  return [nx, ny, ...lengths, ...place].join(" ");
}

export function isSameDomain(a: Placed | undefined, b: Placed | undefined): boolean {
  return domainOf(a) !== "" && domainOf(a) === domainOf(b);
}

// Returns the seconds from the first time of one run to that of another; 0 if their dates cannot be
// compared.
export function laterByS(
  from: Pick<StormDescription, "times"> | undefined,
  to: Pick<StormDescription, "times"> | undefined,
): number {
  const [first = "", other = ""] = [from, to].map((storm) => storm?.times[0]?.validTime);
  return secondsBetween(first, other) ?? 0;
}
