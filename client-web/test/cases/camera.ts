import { fromJson, type JsonValue, toJson } from "@bufbuild/protobuf";
import {
  type CameraKind,
  cameraOfPose,
  drag,
  homeCamera,
  type Pose,
  pan,
  poseOfCamera,
  turn,
  zoom,
} from "../../src/core/camera";
import { type Camera, CameraSchema } from "../../src/gen/thunderhead/v1/scene_pb";
import { Arguments, type Runner } from "./case_files";

export const runCamera: Runner = (given) => {
  let pose = poseOfCamera(fromJson(CameraSchema, given.json("camera")));
  const size = new Arguments(given.json("picture") as Record<string, JsonValue>);
  const picture = { widthPx: size.number("width_px"), heightPx: size.number("height_px") };
  size.expectAllRead();
  const observed = (camera: Camera | undefined) => ({
    camera: camera === undefined ? null : toJson(CameraSchema, camera),
  });
  const moved = (motion: (pose: Pose) => Pose) => {
    pose = pose && motion(pose);
    return observed(pose && cameraOfPose(pose));
  };
  return {
    read: () => moved((before) => before),
    drag: (step) => {
      const [rightPx, downPx] = [step.number("right_px"), step.number("down_px")];
      return moved((before) => drag(before, rightPx, downPx, picture));
    },
    pan: (step) => {
      const [rightPx, downPx] = [step.number("right_px"), step.number("down_px")];
      return moved((before) => pan(before, rightPx, downPx, picture));
    },
    turn: (step) => {
      const [azimuthDeg, elevationDeg] = [step.number("azimuth_deg"), step.number("elevation_deg")];
      return moved((before) => turn(before, azimuthDeg, elevationDeg));
    },
    zoom: (step) => {
      const factor = step.number("factor");
      return moved((before) => zoom(before, factor));
    },
    home: (step) => observed(homeCamera(step.text("kind") as CameraKind)),
  };
};
