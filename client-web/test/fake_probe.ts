// Test support: the made-up storm as numbers, from above and along a ray. Each field is a bell
// curve around the middle of its blobs.
import { create } from "@bufbuild/protobuf";
import {
  GetStormMapResponseSchema,
  type ProbeRayRequest,
  ProbeRayResponseSchema,
  ProbeRayResponse_Seen as Seen,
} from "../src/gen/thunderhead/v1/probe_pb";
import { Hydrometeor } from "../src/gen/thunderhead/v1/scene_pb";
import { BLOBS, type Blob3 } from "./fake_storm";
import { tableOf } from "./place_tables";

// A map whose parallels and meridians are straight, for the storm's place.
const MIDDLE = { latitudeDeg: 29.6, longitudeDeg: -94.7 };
const PLACES = tableOf(
  MIDDLE,
  (longitudeDeg, latitudeDeg) => [
    111_000 * Math.cos((MIDDLE.latitudeDeg * Math.PI) / 180) * longitudeDeg,
    111_000 * latitudeDeg,
  ],
  2,
);

const SIDE_PX = 64;
const HALF_M = 40_000;
const MAX_KG_PER_KG = 4e-3;
const DOMAIN = {
  low: { xM: -HALF_M, yM: -HALF_M, zM: 0 },
  high: { xM: HALF_M, yM: HALF_M, zM: 20_000 },
};
const FIELDS = [
  Hydrometeor.CLOUD,
  Hydrometeor.RAIN,
  Hydrometeor.ICE,
  Hydrometeor.SNOW,
  Hydrometeor.GRAUPEL,
];

function bell({ at, radius }: Blob3, x: number, y: number, z: number): number {
  const [dx, dy, dz] = [x - at[0], y - at[1], z - at[2]];
  return Math.exp((-4 * (dx * dx + dy * dy + dz * dz)) / (radius * radius));
}

export function fakeStormMap(stormId: string, timeIndex: number) {
  const values = Array.from({ length: SIDE_PX * SIDE_PX }, (_, pixel) => {
    const x = ((pixel % SIDE_PX) / SIDE_PX - 0.5) * 2 * HALF_M;
    const y = (Math.floor(pixel / SIDE_PX) / SIDE_PX - 0.5) * 2 * HALF_M;
    return BLOBS.reduce((sum, blob) => sum + 8 * bell(blob, x, y, blob.at[2]), 0);
  });
  const maxima = FIELDS.map((hydrometeor) => {
    const blob = BLOBS.find((each) => each.hydrometeor === hydrometeor);
    const [xM, yM, zM] = blob?.at ?? [0, 0, 0];
    const value = MAX_KG_PER_KG;
    return {
      hydrometeor,
      variable: `Q${hydrometeor}`,
      units: "kg kg-1",
      value,
      position: { xM, yM, zM },
    };
  });
  return create(GetStormMapResponseSchema, {
    stormId: stormId || "supercell",
    timeIndex,
    widthPx: SIDE_PX,
    heightPx: SIDE_PX,
    values,
    units: "kg m-2",
    maximum: Math.max(...values),
    ...DOMAIN,
    middle: MIDDLE,
    projection: "+proj=eqc +lat_ts=29.6 +lat_0=29.6 +lon_0=-94.7 +R=6371000",
    places: PLACES,
    maxima,
  });
}

export function fakeProbe({ through, samples = 128 }: ProbeRayRequest) {
  const ray = through.case === "ray" ? through.value : undefined;
  const [ox, oy, oz] = [ray?.origin?.xM ?? 0, ray?.origin?.yM ?? 0, ray?.origin?.zM ?? 0];
  const [dx, dy, dz] = [ray?.direction?.x ?? 0, ray?.direction?.y ?? 1, ray?.direction?.z ?? 0];
  const length = Math.hypot(dx, dy, dz);
  const place = (distanceM: number) => {
    const [xM, yM, zM] = [ox, oy, oz].map(
      (from, axis) => from + (distanceM * ([dx, dy, dz][axis] ?? 0)) / length,
    ) as [number, number, number];
    return { distanceM, position: { xM, yM, zM }, heightM: zM, heightAboveGroundM: zM };
  };
  const distancesM = Array.from({ length: samples }, (_, at) => 40_000 + at * 640);
  const fields = FIELDS.map((hydrometeor) => {
    const values = distancesM.map((distanceM) => {
      const { xM, yM, zM } = place(distanceM).position;
      const blobs = BLOBS.filter((blob) => blob.hydrometeor === hydrometeor);
      return MAX_KG_PER_KG * blobs.reduce((sum, blob) => sum + bell(blob, xM, yM, zM), 0);
    });
    const maximum = Math.max(0, ...values);
    const maximumPlace = place(distancesM[values.indexOf(maximum)] ?? 0);
    return {
      hydrometeor,
      variable: `Q${hydrometeor}`,
      units: "kg kg-1",
      values,
      maximum,
      maximumPlace,
    };
  });
  const all = distancesM.map((_, at) =>
    fields.reduce((sum, field) => sum + (field.values[at] ?? 0), 0),
  );
  const first = all.findIndex((value) => value > 1e-4);
  const cloud = first < 0 ? undefined : place(distancesM[first] ?? 0);
  return create(ProbeRayResponseSchema, {
    opticalDepth: 1e4 * all.reduce((sum, value) => sum + value, 0),
    seen: cloud === undefined ? Seen.SKY : Seen.CLOUD,
    seenPlace: cloud,
    firstCloud: cloud,
    depthOne: cloud && place(cloud.distanceM + 640),
    distancesM: samples === 0 ? [] : distancesM,
    fields,
  });
}
