// Finds places on Earth in world coordinates by the table that the server sends with the storm's
// map. The server makes the table with the projection of the model's grid, so this code needs no
// formulas of map projections.
import type { EarthPlace, PlaceTable } from "../gen/thunderhead/v1/probe_pb";

// A function from a longitude and latitude in degrees to metres east and north of the domain's
// middle. It returns undefined for a place outside the table or beyond the map.
export type WorldOfPlace = (
  longitudeDeg: number,
  latitudeDeg: number,
) => readonly [number, number] | undefined;

const EARTH_M = 6_371_000;
// Neighbouring nodes whose distance on the map exceeds this number times their distance on Earth
// lie on different sides of a cut through the map.
const MOST_STRETCH = 8;

export function worldByTable(
  middle: Pick<EarthPlace, "latitudeDeg" | "longitudeDeg">,
  { nodes, reachDeg, xM, yM }: Pick<PlaceTable, "nodes" | "reachDeg" | "xM" | "yM">,
): WorldOfPlace {
  const reach = radians(reachDeg);
  const step = (2 * reach) / (nodes - 1);
  const mostM = MOST_STRETCH * step * EARTH_M;
  const [sinMiddle, cosMiddle] = sinCos(radians(middle.latitudeDeg));
  return (longitudeDeg, latitudeDeg) => {
    // Azimuthal equidistant coordinates of the place around the middle.
    const [sin, cos] = sinCos(radians(latitudeDeg));
    const [sinTurn, cosTurn] = sinCos(radians(longitudeDeg - middle.longitudeDeg));
    const east = cos * sinTurn;
    const north = cosMiddle * sin - sinMiddle * cos * cosTurn;
    const across = Math.hypot(east, north);
    const distance = Math.atan2(across, sinMiddle * sin + cosMiddle * cos * cosTurn);
    const scale = across > 0 ? distance / across : 1;
    const column = (east * scale + reach) / step;
    const row = (north * scale + reach) / step;
    const [left, low] = [Math.floor(column), Math.floor(row)];
    if (!(left >= 0 && low >= 0 && left < nodes - 1 && low < nodes - 1)) return undefined;
    const at = low * nodes + left;
    const corners = [at, at + 1, at + nodes, at + nodes + 1];
    const x = corners.map((corner) => xM[corner] ?? Number.NaN);
    const y = corners.map((corner) => yM[corner] ?? Number.NaN);
    if (!(spread(x) < mostM && spread(y) < mostM)) return undefined;
    return [between(x, column - left, row - low), between(y, column - left, row - low)];
  };
}

// Interpolates linearly between the values at the south-west, south-east, north-west and north-east
// corner of a cell.
function between(corners: readonly number[], right: number, up: number): number {
  const [southWest = 0, southEast = 0, northWest = 0, northEast = 0] = corners;
  const south = southWest + right * (southEast - southWest);
  const north = northWest + right * (northEast - northWest);
  return south + up * (north - south);
}

// Returns the largest difference of two values; NaN if a value is NaN.
function spread(values: readonly number[]): number {
  return Math.max(...values) - Math.min(...values);
}

function sinCos(angle: number): readonly [number, number] {
  return [Math.sin(angle), Math.cos(angle)];
}

function radians(degrees: number): number {
  return (degrees * Math.PI) / 180;
}
