// Test support: the storms and scenes of the fake. It has the descriptions of storms, and fills in
// a scene's defaults.
import { create } from "@bufbuild/protobuf";
import { cameraOfPose, poseOfCamera } from "../src/core/camera";
import { azimuthTo } from "../src/core/map_frame";
import { LIMITS, withCamera, withOutput } from "../src/core/scene";
import {
  CameraSchema,
  FieldParametersSchema,
  Hydrometeor,
  PhaseFunction_Kind as Kind,
  type Scene,
} from "../src/gen/thunderhead/v1/scene_pb";
import {
  FieldDescription_SizeOrigin,
  StormDescriptionSchema,
} from "../src/gen/thunderhead/v1/storm_pb";
import { completeRendering } from "./fake_techniques";

export type Draw = (scene: Scene, widthPx: number, heightPx: number) => Uint8Array;

const FIELDS = [
  Hydrometeor.CLOUD,
  Hydrometeor.RAIN,
  Hydrometeor.ICE,
  Hydrometeor.SNOW,
  Hydrometeor.GRAUPEL,
] as const;

const FALSE_COLORS = [
  { red: 1, green: 0, blue: 0 },
  { red: 0, green: 0, blue: 1 },
  { red: 1, green: 0, blue: 1 },
  { red: 1, green: 1, blue: 0 },
  { red: 0, green: 1, blue: 0 },
] as const;

// Describes a storm. `later` is the number of times that were added since the start.
export function describeStorm(stormId: string, timeIndex: number, later = 0) {
  const count = stormId === "supercell" ? 4 + later : 1;
  return create(StormDescriptionSchema, {
    id: stormId,
    title: stormId,
    timeIndex,
    assumptions: stormId === "late" ? ["Mixing ratios are per kg of dry air."] : [],
    // These two storms are runs of one model. The domains of the others are unknown.
    grid: ["supercell", "late"].includes(stormId)
      ? { nx: 200, ny: 160, nz: 68, dxM: 1000, dyM: 1000, dzM: 300 }
      : undefined,
    times: Array.from({ length: count }, (_, index) => ({
      index,
      validTime: `0001-01-01T0${Math.floor((index + 1) / 3)}:${((index + 1) % 3) * 2}0:00Z`,
      elapsedS: index * 1200,
    })),
    fields: FIELDS.map((hydrometeor, i) => ({
      hydrometeor,
      variable: "Q",
      units: "kg kg-1",
      maximum: 4e-3,
      meanWaterPathKgPerM2: 0.8,
      sizeOrigin: FieldDescription_SizeOrigin.SCHEME,
      sizeScheme: "WSM6",
      meanRadiusM: 2e-5 * 10 ** i,
      papersRadiusM: 1e-5 * 10 ** i,
      defaults: create(FieldParametersSchema, {
        hydrometeor,
        visible: true,
        scale: 1,
        densityKgPerM3: 1000,
        albedo: 1,
        phase: { kind: Kind.CORNETTE_SHANKS, asymmetry: 0.85 },
        falseColor: FALSE_COLORS[i],
      }),
    })),
  });
}

// This camera sees the whole storm.
const HOME = cameraOfPose({
  kind: "orbit",
  targetM: [4000, 0, 7000],
  azimuthDeg: 200,
  elevationDeg: 8,
  distanceM: 80_000,
  fieldOfViewDeg: 35,
});

// Fills in missing parts of the camera, so that it looks at the storm's middle or shows all of it.
function completeCamera(camera: Scene["camera"]): Scene["camera"] {
  const { kind } = camera ?? {};
  if (kind?.case === "spotter") {
    const { xM = 0, yM = -30_000, azimuthDeg = azimuthTo([xM, yM], [0, 0]) } = kind.value;
    const value = {
      ...kind.value,
      xM,
      yM,
      azimuthDeg,
      elevationDeg: kind.value.elevationDeg ?? 10,
    };
    return create(CameraSchema, { kind: { case: "spotter", value } });
  }
  if (kind?.case === "topDown") {
    const { xM = 0, yM = 0, widthM = 100_000 } = kind.value;
    return create(CameraSchema, { kind: { case: "topDown", value: { xM, yM, widthM } } });
  }
  if (kind?.case === "orbit" && kind.value.target !== undefined) {
    const { elevationDeg = 8, distanceM = 80_000 } = kind.value;
    return create(CameraSchema, {
      kind: { case: "orbit", value: { ...kind.value, elevationDeg, distanceM } },
    });
  }
  return camera;
}

// A scene without a time gets the first time. The server would show the last one, but tests step
// forward from here.
export function completeScene(scene: Scene): Scene {
  const stormId = scene.stormId === "" ? "supercell" : scene.stormId;
  const rendering = completeRendering(scene.rendering);
  const asked = completeCamera(scene.camera);
  const camera = asked !== undefined && poseOfCamera(asked) !== undefined ? asked : HOME;
  const fields = describeStorm(stormId, 0).fields.flatMap(({ hydrometeor, defaults }) => {
    const set = scene.fields.find((field) => field.hydrometeor === hydrometeor) ?? defaults;
    return set === undefined ? [] : [set];
  });
  const completed = { ...scene, stormId, timeIndex: scene.timeIndex ?? 0, rendering, fields };
  return withOutput(withCamera(completed, camera), {
    widthPx: scene.output?.widthPx ?? LIMITS.width.defaultValue,
    heightPx: scene.output?.heightPx ?? LIMITS.height.defaultValue,
    jpegQuality: scene.output?.jpegQuality ?? LIMITS.jpegQuality.defaultValue,
  });
}
