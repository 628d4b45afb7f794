// Coasts, borders and states as lines in world metres. This code and its data are loaded when the
// map of a storm with a map projection first opens.
import { mesh } from "topojson-client";
import type { GeometryCollection, Topology } from "topojson-specification";
import { type WorldOfPlace, worldByTable } from "../../core/place_table";
import type { EarthPlace, PlaceTable } from "../../gen/thunderhead/v1/probe_pb";

export interface MapLines {
  // SVG paths in metres, x to the east and y to the south.
  readonly countries: string;
  readonly states: string;
}

// Returns the parts of the lines that lie in the area of the table of places. The lines of states
// are returned only for the area around the United States.
export async function mapLines(middle: EarthPlace, places: PlaceTable): Promise<MapLines> {
  const world = worldByTable(middle, places);
  const atlas = (await import("world-atlas/countries-50m.json")).default as unknown as Atlas;
  const countries = pathOf(mesh(atlas, atlas.objects.countries).coordinates, world);
  if (!nearUnitedStates(middle)) return { countries, states: "" };
  const nation = (await import("us-atlas/states-10m.json")).default as unknown as StatesAtlas;
  const inner = mesh(nation, nation.objects.states, (a, b) => a !== b);
  return { countries, states: pathOf(inner.coordinates, world) };
}

type Line = readonly (readonly number[])[];

// The data's lines are straight in degrees and curved on the map, so longer pieces are divided.
const LONGEST_PIECE_DEG = 0.1;
// The data cuts countries at the meridian of 180°. These cuts are not borders.
const CUT_DEG = 179.99;

// Returns lines of longitudes and latitudes as a path. A line is interrupted where it leaves the
// map, and at the meridian of 180°.
export function pathOf(lines: readonly Line[], world: WorldOfPlace): string {
  const parts: string[] = [];
  for (const line of lines) {
    let open = false;
    let [fromEast, fromNorth] = [0, 0];
    line.forEach(([east = 0, north = 0], index) => {
      const isCut = Math.abs(east) > CUT_DEG && Math.abs(fromEast) > CUT_DEG;
      if (index === 0 || isCut) open = false;
      const long = Math.max(Math.abs(east - fromEast), Math.abs(north - fromNorth));
      const pieces = index === 0 || isCut ? 1 : Math.max(1, Math.ceil(long / LONGEST_PIECE_DEG));
      for (let piece = 1; piece <= pieces; piece += 1) {
        const share = piece / pieces;
        const place = world(
          east - (1 - share) * (east - fromEast),
          north - (1 - share) * (north - fromNorth),
        );
        if (place !== undefined)
          parts.push(`${open ? "L" : "M"}${Math.round(place[0])},${Math.round(-place[1])}`);
        open = place !== undefined;
      }
      [fromEast, fromNorth] = [east, north];
    });
  }
  return parts.join("");
}

type Atlas = Topology<{ countries: GeometryCollection }>;
type StatesAtlas = Topology<{ states: GeometryCollection }>;

function nearUnitedStates({ latitudeDeg, longitudeDeg }: EarthPlace): boolean {
  return latitudeDeg > 15 && latitudeDeg < 72 && longitudeDeg > -180 && longitudeDeg < -60;
}
