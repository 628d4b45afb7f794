// Coasts, borders and states as lines in world metres, by the projection of the model's grid. This
// code and its data are loaded when the map of a storm with geographical coordinates first opens.
import {
  type GeoProjection,
  geoAzimuthalEquidistant,
  geoConicConformal,
  geoMercator,
  geoPath,
  geoProjection,
  geoStereographic,
} from "d3-geo";
import { mesh } from "topojson-client";
import type { GeometryCollection, Topology } from "topojson-specification";
import type { Extent } from "../../core/map_frame";

// Radius of WRF's Earth.
const EARTH_M = 6_370_000;
// Maximum distance between a projected curve and its approximation by straight lines.
const PRECISION_M = 500;

export interface GridPlace {
  // The projection in PROJ's notation; may be empty.
  readonly projection: string;
  readonly latitudeDeg: number;
  readonly longitudeDeg: number;
}

// Returns d3's projection from a longitude and latitude to metres east and north of the domain's
// middle. d3's y coordinate increases to the south.
export function gridProjection(place: GridPlace): GeoProjection {
  const projection = unshifted(place).translate([0, 0]).precision(PRECISION_M);
  const middle = projection([place.longitudeDeg, place.latitudeDeg]) ?? [0, 0];
  return projection.translate([-middle[0], -middle[1]]);
}

// Returns the grid's projection without an offset. A projection that the page does not know is
// approximated by an azimuthal projection, which is accurate near the domain's middle.
function unshifted({ projection, latitudeDeg, longitudeDeg }: GridPlace): GeoProjection {
  const number = (name: string): number | undefined => {
    const text = new RegExp(`\\+${name}=(-?[\\d.]+)`).exec(projection)?.[1];
    return text === undefined ? undefined : Number(text);
  };
  const earthM = number("R") ?? number("a") ?? EARTH_M;
  const lon0 = number("lon_0") ?? longitudeDeg;
  switch (/\+proj=(\w+)/.exec(projection)?.[1]) {
    case "lcc": {
      const lat1 = number("lat_1") ?? latitudeDeg;
      return geoConicConformal()
        .parallels([lat1, number("lat_2") ?? lat1])
        .rotate([-lon0, 0])
        .scale(earthM);
    }
    case "merc":
      return geoMercator()
        .rotate([-lon0, 0])
        .scale(earthM * Math.cos(radians(number("lat_ts") ?? 0)));
    case "stere": {
      const pole = (number("lat_0") ?? 90) < 0 ? -90 : 90;
      const trueAt = Math.abs(number("lat_ts") ?? 90);
      return geoStereographic()
        .rotate([-lon0, -pole])
        .scale(earthM * (1 + Math.sin(radians(trueAt))));
    }
    case "eqc": {
      const narrower = Math.cos(radians(number("lat_ts") ?? 0));
      return geoProjection((lambda, phi) => [lambda * narrower, phi])
        .rotate([-lon0, 0])
        .scale(earthM);
    }
    default:
      return geoAzimuthalEquidistant().rotate([-longitudeDeg, -latitudeDeg]).scale(earthM);
  }
}

export interface MapLines {
  // SVG paths in metres, x to the east and y to the south.
  readonly countries: string;
  readonly states: string;
}

export async function mapLines(place: GridPlace, extent: Extent): Promise<MapLines> {
  const projection = gridProjection(place).clipExtent([
    [extent.westM, -extent.northM],
    [extent.eastM, -extent.southM],
  ]);
  const path = geoPath(projection).digits(0);
  const world = (await import("world-atlas/countries-50m.json")).default as unknown as Atlas;
  const countries = path(mesh(world, world.objects.countries)) ?? "";
  if (!nearUnitedStates(place)) return { countries, states: "" };
  const nation = (await import("us-atlas/states-10m.json")).default as unknown as StatesAtlas;
  const states = path(mesh(nation, nation.objects.states, (a, b) => a !== b)) ?? "";
  return { countries, states };
}

type Atlas = Topology<{ countries: GeometryCollection }>;
type StatesAtlas = Topology<{ states: GeometryCollection }>;

function nearUnitedStates({ latitudeDeg, longitudeDeg }: GridPlace): boolean {
  return latitudeDeg > 15 && latitudeDeg < 72 && longitudeDeg > -180 && longitudeDeg < -60;
}

function radians(degrees: number): number {
  return (degrees * Math.PI) / 180;
}
