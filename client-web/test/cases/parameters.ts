import { fromJson, type JsonValue, toJson } from "@bufbuild/protobuf";
import { type Parameter, parametersOf, withParameter } from "../../src/core/parameters";
import { SceneSchema } from "../../src/gen/thunderhead/v1/scene_pb";
import type { Runner } from "./case_files";

function described(parameter: Parameter | undefined): JsonValue {
  if (parameter === undefined) return null;
  const { fullName, name, group, kind } = parameter;
  const common = { full_name: fullName, name, group, kind };
  if (kind === "flag") return { ...common, default_on: parameter.defaultOn };
  if (kind !== "choice") return common;
  return { ...common, options: parameter.options.map((option) => [option.value, option.name]) };
}

export const runParameters: Runner = (given) => {
  let scene = fromJson(SceneSchema, given.json("scene"));
  // The list as it was before the steps.
  const parameters = parametersOf(scene);
  const find = (path: string) => parameters.find((each) => each.path === path);
  const set = (path: string, value: unknown) => {
    const parameter = find(path);
    if (parameter === undefined) throw new Error(`the scene has no parameter ${path}`);
    scene = withParameter(scene, parameter, value);
    return { scene: toJson(SceneSchema, scene) };
  };
  return {
    parameter: (step) => ({ parameter: described(find(step.text("path"))) }),
    set: (step) => set(step.text("path"), step.json("value")),
    clear: (step) => set(step.text("path"), undefined),
    replace: (step) => {
      scene = fromJson(SceneSchema, step.json("scene"));
      return { scene: toJson(SceneSchema, scene) };
    },
  };
};
