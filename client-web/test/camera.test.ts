import { describe, expect, it } from "vitest";
import {
  cameraOfPose,
  homeCamera,
  type OrbitPose,
  orbit,
  pan,
  pictureAxes,
  poseOfCamera,
  turn,
  wrapDegrees,
  zoom,
} from "../src/core/camera";

// Stands due south of the target and looks north.
const SOUTH: OrbitPose = {
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
    const turned = orbit(SOUTH, 100, 50, 600);
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
    const moved = pan(SOUTH, 30, 60, 600);
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
