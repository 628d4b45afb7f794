// Parameters of a cloud for the server's generator, as the panel edits them, and the request that
// is made from them.
import { create } from "@bufbuild/protobuf";
import {
  type GenerateCloudRequest,
  type GenerateCloudRequest_Ellipsoid,
  GenerateCloudRequest_EllipsoidSchema,
  GenerateCloudRequestSchema,
  GenerateCloudRequest_Interpolation as Interpolation,
  GenerateCloudRequest_Preset as Preset,
} from "../gen/thunderhead/v1/cloud_pb";
import { type Limits, limitsOf } from "./limits";

export interface CloudDraft {
  readonly preset: Preset;
  readonly seed: number;
  // If false, the preset determines all values below.
  readonly ownShape: boolean;
  readonly octaves: number;
  readonly persistence: number;
  readonly interpolation: Interpolation;
  readonly featureSizeM: number;
  readonly threshold: number;
  readonly dynamics: number;
  readonly waterKgPerM3: number;
  // A text with one ellipsoid a line, given as numbers separated by commas. The numbers are the
  // centre's x, y, z and the radii along x, y, z in metres, and optionally the rotations about x,
  // y, z in degrees. An empty text means the preset's ellipsoids.
  readonly ellipsoids: string;
}

export const FIRST_CLOUD: CloudDraft = {
  preset: Preset.FAIR_WEATHER_CUMULUS,
  seed: 1,
  ownShape: false,
  octaves: 4,
  persistence: 0.5,
  interpolation: Interpolation.CUBIC,
  featureSizeM: 400,
  threshold: 0.1,
  dynamics: 1,
  waterKgPerM3: 2e-3,
  ellipsoids: "",
};

const { field } = GenerateCloudRequestSchema;

export const CLOUD_LIMITS = {
  seed: limitsOf(field.seed),
  octaves: limitsOf(field.octaves),
  persistence: limitsOf(field.persistence),
  featureSize: limitsOf(field.featureSizeM),
  threshold: limitsOf(field.threshold),
  dynamics: limitsOf(field.dynamics),
  water: limitsOf(field.waterKgPerM3),
} as const satisfies Record<string, Limits>;

// Makes the request. Throws an Error that names the line if an ellipsoid is malformed.
export function requestOfCloud(draft: CloudDraft): GenerateCloudRequest {
  const { preset, seed } = draft;
  if (!draft.ownShape) return create(GenerateCloudRequestSchema, { preset, seed });
  const { octaves, persistence, interpolation, featureSizeM, threshold, dynamics, waterKgPerM3 } =
    draft;
  return create(GenerateCloudRequestSchema, {
    preset,
    seed,
    octaves,
    persistence,
    interpolation,
    featureSizeM,
    threshold,
    dynamics,
    waterKgPerM3,
    ellipsoids: ellipsoidsOf(draft.ellipsoids),
  });
}

function ellipsoidsOf(text: string): GenerateCloudRequest_Ellipsoid[] {
  const lines = text.split("\n").map((line) => line.trim());
  return lines.flatMap((line, index) => {
    if (line === "") return [];
    const numbers = line.split(",").map((part) => (part.trim() === "" ? Number.NaN : Number(part)));
    if ((numbers.length !== 6 && numbers.length !== 9) || !numbers.every(Number.isFinite)) {
      throw new Error(
        `Line ${index + 1} of the ellipsoids is "${line}"; it must be six numbers, or nine with a rotation, separated by commas`,
      );
    }
    const [xM, yM, zM, radiusXM, radiusYM, radiusZM, rotationXDeg, rotationYDeg, rotationZDeg] =
      numbers;
    const turned = numbers.length === 9 ? { rotationXDeg, rotationYDeg, rotationZDeg } : {};
    const shape = { xM, yM, zM, radiusXM, radiusYM, radiusZM, ...turned };
    // The cast is safe because the length was checked above.
    return [create(GenerateCloudRequest_EllipsoidSchema, shape as Required<typeof shape>)];
  });
}
