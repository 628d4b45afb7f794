import { create, fromJson } from "@bufbuild/protobuf";
import { clampToLimits, type Limits } from "../../src/core/limits";
import { parametersOf } from "../../src/core/parameters";
import { type Scene, SceneSchema } from "../../src/gen/thunderhead/v1/scene_pb";
import type { Runner } from "./case_files";

function limitsAt(scene: Scene, path: string): Limits {
  const parameter = parametersOf(scene).find((each) => each.path === path);
  if (parameter?.kind !== "number") throw new Error(`${path} is no number of the scene`);
  return parameter.limits;
}

export const runLimits: Runner = (given) => {
  const scene = fromJson(SceneSchema, given.json("scene"));
  return {
    limits: (step) => {
      const limits = limitsAt(scene, step.text("path"));
      const { minimum, maximum, defaultValue = null, unit, logarithmic } = limits;
      return { minimum, maximum, default: defaultValue, unit, logarithmic };
    },
  };
};

export const runClamp: Runner = () => ({
  clamp: (step) => {
    const limits = limitsAt(create(SceneSchema), step.text("path"));
    return { value: clampToLimits(step.number("value"), limits) };
  },
});
