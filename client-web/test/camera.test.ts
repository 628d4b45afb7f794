import { describe, expect, it } from "vitest";
import {
  cameraOfPose,
  drag,
  homeCamera,
  type OrbitPose,
  pan,
  pictureAxes,
  poseOfCamera,
  type SpotterPose,
  type TopDownPose,
  turn,
  wrapDegrees,
  zoom,
} from "../src/core/camera";

const PICTURE = { widthPx: 1000, heightPx: 600 };

// This camera stands due south of the target and looks north.
const SOUTH: OrbitPose = {
  kind: "orbit",
  targetM: [1000, 2000, 3000],
  azimuthDeg: 180,
  elevationDeg: 0,
  distanceM: 10_000,
  fieldOfViewDeg: 90,
};

describe("the orbit camera", () => {
  it("has east at its right and up above when it looks north", () => {
    const { right, up } = pictureAxes(SOUTH);
    expect(right[0]).toBeCloseTo(1, 12);
    expect(right[1]).toBeCloseTo(0, 12);
    expect(up).toEqual([expect.closeTo(0, 12), expect.closeTo(0, 12), 1]);
  });

  it("keeps its axes at right angles to each other and to the line of sight", () => {
    const pose = turn(SOUTH, 73, 41);
    const { right, up } = pictureAxes(pose);
    const azimuth = (pose.azimuthDeg * Math.PI) / 180;
    const elevation = (pose.elevationDeg * Math.PI) / 180;
    const towardsCamera = [
      Math.sin(azimuth) * Math.cos(elevation),
      Math.cos(azimuth) * Math.cos(elevation),
      Math.sin(elevation),
    ];
    const dot = (a: number[], b: number[]) => a.reduce((sum, v, i) => sum + v * (b[i] ?? 0), 0);
    expect(dot(right, up)).toBeCloseTo(0, 12);
    expect(dot(right, towardsCamera)).toBeCloseTo(0, 12);
    expect(dot(up, towardsCamera)).toBeCloseTo(0, 12);
    expect(dot(up, up)).toBeCloseTo(1, 12);
  });

  it("goes west when the storm is dragged to the right, and up when it is dragged down", () => {
    const turned = drag(SOUTH, 100, 50, PICTURE);
    expect(turned.azimuthDeg).toBeCloseTo(180 + 30, 12);
    expect(turned.elevationDeg).toBeCloseTo(15, 5);
    expect(turned.targetM).toEqual(SOUTH.targetM);
  });

  it("stops short of the zenith and the nadir", () => {
    expect(turn(SOUTH, 0, 500).elevationDeg).toBeLessThanOrEqual(89.9);
    expect(turn(SOUTH, 0, -500).elevationDeg).toBeGreaterThanOrEqual(-89.9);
  });

  it("moves the target so that it follows the pointer", () => {
    // At 90 degrees of view and 10 km, 600 pixels span 20 km.
    const moved = pan(SOUTH, 30, 60, PICTURE);
    expect(moved.targetM[0]).toBeCloseTo(1000 - 1000, 6);
    expect(moved.targetM[1]).toBeCloseTo(2000, 6);
    expect(moved.targetM[2]).toBeCloseTo(3000 + 2000, 6);
  });

  it("zooms by a factor within the limits", () => {
    expect(zoom(SOUTH, 0.5).distanceM).toBe(5000);
    expect(zoom(SOUTH, 1e-9).distanceM).toBe(1);
    expect(zoom(SOUTH, 1e9).distanceM).toBe(5e7);
  });

  it("survives the way to a message and back", () => {
    const pose = poseOfCamera(cameraOfPose({ ...SOUTH, azimuthDeg: -90 }));
    expect(pose).toEqual({ ...SOUTH, azimuthDeg: 270 });
  });

  it("is unknown while the server has not placed it", () => {
    expect(poseOfCamera(homeCamera())).toBeUndefined();
    expect(poseOfCamera(undefined)).toBeUndefined();
  });

  it("wraps azimuths", () => {
    expect([-10, 0, 360, 725].map(wrapDegrees)).toEqual([350, 0, 0, 5]);
  });
});

describe("the spotter", () => {
  const NORTH: SpotterPose = {
    kind: "spotter",
    placeM: [1000, -60_000],
    eyeHeightM: 1.75,
    azimuthDeg: 0,
    elevationDeg: 6,
    focalLengthMm: 24,
  };

  it("turns its head so that what it sees follows the pointer", () => {
    // Through 24 mm the picture's height is 1 radian in the small-angle limit.
    const turned = drag(NORTH, 60, 30, PICTURE);
    expect(turned.azimuthDeg).toBeCloseTo(360 - 18 / Math.PI, 6);
    expect(turned.elevationDeg).toBeCloseTo(6 + 9 / Math.PI, 5);
    expect(turned.placeM).toEqual(NORTH.placeM);
    // A longer lens turns less.
    expect(drag({ ...NORTH, focalLengthMm: 240 }, 60, 0, PICTURE).azimuthDeg).toBeCloseTo(
      360 - 1.8 / Math.PI,
      6,
    );
  });

  it("walks across and along its line of sight", () => {
    const [x, y] = pan({ ...NORTH, azimuthDeg: 90 }, 0, 60, PICTURE).placeM;
    expect(x).toBeCloseTo(3000, 6);
    expect(y).toBeCloseTo(-60_000, 6);
    expect(pan(NORTH, 60, 0, PICTURE).placeM[0]).toBeCloseTo(-1000, 6);
  });

  it("takes a longer lens to see more of less", () => {
    expect(zoom(NORTH, 0.5).focalLengthMm).toBe(48);
  });

  it("survives the way to a message and back", () => {
    expect(poseOfCamera(cameraOfPose(NORTH))).toEqual(NORTH);
    expect(poseOfCamera(homeCamera("spotter"))).toBeUndefined();
  });
});

describe("the camera above", () => {
  const MAP: TopDownPose = { kind: "topDown", centerM: [2000, 3000], widthM: 160_000 };

  const MAP_PICTURE = { widthPx: 160, heightPx: 90 };

  it("moves under the pointer, however it is dragged", () => {
    // The map's scale is one kilometre a pixel.
    expect(drag(MAP, 10, 20, MAP_PICTURE).centerM).toEqual([2000 - 10_000, 3000 + 20_000]);
    expect(pan(MAP, 10, 20, MAP_PICTURE)).toEqual(drag(MAP, 10, 20, MAP_PICTURE));
    expect(turn(MAP, 10, 20)).toEqual(MAP);
  });

  it("shows less when it comes nearer", () => {
    expect(zoom(MAP, 0.5).widthM).toBe(80_000);
  });

  it("survives the way to a message and back", () => {
    expect(poseOfCamera(cameraOfPose(MAP))).toEqual(MAP);
    expect(poseOfCamera(homeCamera("topDown"))).toBeUndefined();
  });
});
