// Tests of the view that the fake server gives a camera, strokes, and the picture's rectangle.
import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { cameraOfPose } from "../src/core/camera";
import { pictureBox, picturePointAt, placeInBox } from "../src/core/picture_box";
import { type Projection, project, projectionOf } from "../src/core/projection";
import { simplifiedStroke, strokeLengthPx } from "../src/core/stroke";
import { ViewSchema } from "../src/gen/thunderhead/v1/frame_pb";
import { viewOfCamera } from "./fake_view";

const ORBIT = cameraOfPose({
  kind: "orbit",
  targetM: [4000, -2000, 7000],
  azimuthDeg: 200,
  elevationDeg: 8,
  distanceM: 60_000,
  fieldOfViewDeg: 35,
});

function projectionFor(camera: typeof ORBIT): Projection {
  const projection = projectionOf(create(ViewSchema, viewOfCamera(camera, 16 / 9)));
  if (projection === undefined) throw new Error("the camera has no view");
  return projection;
}

describe("a projection", () => {
  it("has the orbit's target in the middle, and what is up and right of it up and right", () => {
    const projection = projectionFor(ORBIT);
    const target = project(projection, [4000, -2000, 7000]);
    expect(target?.x).toBeCloseTo(0, 4);
    expect(target?.y).toBeCloseTo(0, 4);
    expect(project(projection, [4000, -2000, 12_000])?.y).toBeGreaterThan(0.1);
    // Seen from the south-south-west, east is at the right.
    expect(project(projection, [9000, -2000, 7000])?.x).toBeGreaterThan(0.1);
  });
});

describe("the picture's box", () => {
  it("is as large as fits, in the middle", () => {
    const wide = pictureBox({ width: 1000, height: 1000 }, { width: 320, height: 160 });
    expect(wide).toEqual({ left: 0, top: 250, width: 1000, height: 500 });
    const tall = pictureBox({ width: 1000, height: 500 }, { width: 100, height: 200 });
    expect(tall).toEqual({ left: 375, top: 0, width: 250, height: 500 });
  });

  it("turns places into points of the picture and back, and has none outside", () => {
    const box = { left: 0, top: 250, width: 1000, height: 500 };
    expect(picturePointAt(box, 0, 250)).toEqual({ x: -1, y: 1 });
    expect(picturePointAt(box, 750, 625)).toEqual({ x: 0.5, y: -0.5 });
    expect(placeInBox(box, { x: 0.5, y: -0.5 })).toEqual({ left: 750, top: 625 });
    expect(picturePointAt(box, 500, 100)).toBeUndefined();
  });
});

describe("a stroke", () => {
  const circle = Array.from({ length: 500 }, (_, i) => ({
    left: 300 + 200 * Math.cos((i / 499) * 2 * Math.PI),
    top: 300 + 200 * Math.sin((i / 499) * 2 * Math.PI),
  }));

  it("keeps a straight line's ends alone, and a corner", () => {
    const line = Array.from({ length: 50 }, (_, i) => ({ left: i, top: 2 * i }));
    expect(simplifiedStroke(line, 64)).toEqual([line[0], line[49]]);
    const bent = [...line, { left: 100, top: 0 }];
    expect(simplifiedStroke(bent, 64)).toEqual([line[0], line[49], { left: 100, top: 0 }]);
  });

  it("keeps a circle round, within the number of corners", () => {
    const kept = simplifiedStroke(circle, 64);
    expect(kept.length).toBeLessThanOrEqual(64);
    expect(kept.length).toBeGreaterThan(12);
    const radii = kept.slice(1).map((point, i) => {
      const before = kept[i] ?? point;
      const middle = [(point.left + before.left) / 2 - 300, (point.top + before.top) / 2 - 300];
      return Math.hypot(middle[0] ?? 0, middle[1] ?? 0);
    });
    expect(Math.min(...radii)).toBeGreaterThan(197);
  });

  it("gives corners up where there are too many", () => {
    const zigzag = Array.from({ length: 400 }, (_, i) => ({ left: i, top: i % 2 === 0 ? 0 : 5 }));
    const kept = simplifiedStroke(zigzag, 64);
    expect(kept.length).toBeLessThanOrEqual(64);
    expect([kept[0], kept.at(-1)]).toEqual([zigzag[0], zigzag[399]]);
  });

  it("keeps both ends, however few corners are allowed", () => {
    expect(simplifiedStroke(circle.slice(0, 200), 1)).toEqual([circle[0], circle[199]]);
  });

  it("has a length", () => {
    expect(strokeLengthPx([])).toBe(0);
    expect(strokeLengthPx(circle)).toBeCloseTo(2 * Math.PI * 200, -1);
  });
});
