import { fromJson, type JsonValue } from "@bufbuild/protobuf";
import {
  type PicturePoint,
  project,
  projectionOf,
  projectLine,
  rayAt,
  type Vec3,
} from "../../src/core/projection";
import { ViewSchema } from "../../src/gen/thunderhead/v1/frame_pb";
import type { Runner } from "./case_files";

const vector = (value: JsonValue) => value as unknown as Vec3;
const pair = ({ x, y }: PicturePoint): JsonValue => [x, y];

export const runProjection: Runner = (given) => {
  const projection = projectionOf(fromJson(ViewSchema, given.json("view")));
  return {
    project: (step) => {
      const pointM = vector(step.json("point_m"));
      const at = projection && project(projection, pointM);
      return { at: at === undefined ? null : pair(at) };
    },
    project_line: (step) => {
      const pointsM = (step.json("points_m") as JsonValue[]).map(vector);
      const parts = projection === undefined ? [] : projectLine(projection, pointsM);
      return { parts: parts.map((part) => part.map(pair)) };
    },
    ray: (step) => {
      if (projection === undefined) throw new Error("the view is incomplete");
      const point = { x: step.number("x"), y: step.number("y") };
      const { originM, direction } = rayAt(projection, point);
      return { origin_m: [...originM], direction: [...direction] };
    },
  };
};
