// A cloud to be made by the server's generator, as the page edits it, and the request that it becomes.
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
  // False leaves all below to the preset.
  readonly ownShape: boolean;
  readonly octaves: number;
  readonly persistence: number;
  readonly interpolation: Interpolation;
  readonly featureSizeM: number;
  readonly threshold: number;
  readonly dynamics: number;
  readonly waterKgPerM3: number;
  // One a line: middle x, y, z, radii x, y, z in m, and turned about x, y, z by degrees, with commas. Empty for the
  // preset's.
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

// Throws an Error that names the line of an ellipsoid that is none.
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
        `Line ${index + 1} of the ellipsoids is "${line}"; it must be six numbers, or nine with a rotation, with commas`,
      );
    }
    const [xM, yM, zM, radiusXM, radiusYM, radiusZM, rotationXDeg, rotationYDeg, rotationZDeg] =
      numbers;
    const turned = numbers.length === 9 ? { rotationXDeg, rotationYDeg, rotationZDeg } : {};
    const shape = { xM, yM, zM, radiusXM, radiusYM, radiusZM, ...turned };
    // The length was checked above.
    return [create(GenerateCloudRequest_EllipsoidSchema, shape as Required<typeof shape>)];
  });
}
