// Tests of the axes of an orbit camera. The shared cases (tests/clients/cases/camera.json) test the
// motions of cameras.
import { describe, expect, it } from "vitest";
import { type OrbitPose, pictureAxes, turn, wrapDegrees } from "../src/core/camera";

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

  it("wraps azimuths", () => {
    expect([-10, 0, 360, 725].map(wrapDegrees)).toEqual([350, 0, 0, 5]);
  });
});
