// Tests of annotations over the picture and on the map, the comparison, the probe, and the list of
// all parameters.
import { create } from "@bufbuild/protobuf";
import { afterEach, expect, test } from "vitest";
import {
  type Annotated,
  annotationsOf,
  FIRST_ANNOTATIONS,
  letterPxOf,
  type Shape,
  type TextShape,
  widthForPx,
} from "../src/core/annotations";
import type { OrbitPose, SpotterPose, TopDownPose } from "../src/core/camera";
import { comparedScene } from "../src/core/comparison";
import { stretchesOf } from "../src/core/held_times";
import { arrowStrokes, joined, letterStrokes, parted } from "../src/core/lettering";
import {
  azimuthTo,
  extentOf,
  placeFrom,
  placeOnMap,
  standOf,
  worldOfMap,
} from "../src/core/map_frame";
import {
  instantOf,
  localClock,
  minutesAhead,
  momentOf,
  secondsBetween,
  zoneOfLongitude,
} from "../src/core/moment";
import { parametersOf, parameterValue, withParameter } from "../src/core/parameters";
import { worldByTable } from "../src/core/place_table";
import { displacementBetween } from "../src/core/probe";
import type { Projection } from "../src/core/projection";
import { withTechnique } from "../src/core/rendering";
import { withField, withRendering } from "../src/core/scene";
import {
  atMinute,
  clockHere,
  firstDateTime,
  minuteOfDay,
  sunriseAndSunset,
} from "../src/core/sun_clock";
import { toolOfKey } from "../src/core/tools";
import { formatLength, lengthUnits, roundLength } from "../src/core/units";
import { COMMENTS } from "../src/gen/comments";
import { RayPlaceSchema } from "../src/gen/thunderhead/v1/probe_pb";
import { Hydrometeor, RenderingSchema, SceneSchema } from "../src/gen/thunderhead/v1/scene_pb";
import { StormDescriptionSchema } from "../src/gen/thunderhead/v1/storm_pb";
import { pathOf } from "../src/view/tools/map_lines";
import { tableOf } from "./place_tables";

afterEach(() => {
  lengthUnits.value = "metric";
});

// This view looks north from the middle of the world, and is 60 degrees wide.
const HALF = Math.tan(Math.PI / 6);
const NORTH: Projection = {
  eyeM: [0, 0, 2],
  forward: [0, 1, 0],
  right: [HALF, 0, 0],
  up: [0, 0, HALF / 2],
  parallel: false,
};
const SPOTTER: SpotterPose = {
  kind: "spotter",
  placeM: [0, 0],
  eyeHeightM: 2,
  azimuthDeg: 0,
  elevationDeg: 0,
  focalLengthMm: 24,
};
const PICTURE: Annotated = {
  widthPx: 800,
  heightPx: 400,
  inset: { left: 0, top: 0, right: 0, bottom: 0 },
  letterPx: 10,
  projection: NORTH,
  pose: SPOTTER,
  trueNorthDeg: 0,
  groundM: 0,
  title: "A storm",
  time: "2013-05-20 20:00Z",
  legend: [{ name: "Rain", color: "#112233" }],
};

const wrapped = (deg: number) => deg - 360 * Math.round(deg / 360);

// A Lambert conic projection of a sphere with standard parallels at 30 and 60 degrees, from 35 N 97
// W. The formulas are equations 15-1 to 15-5 of Snyder 1987, "Map Projections - A Working Manual".
function lambert(longitudeDeg: number, latitudeDeg: number): [number, number] {
  const radian = Math.PI / 180;
  const stretched = (deg: number) => Math.tan(Math.PI / 4 + (deg * radian) / 2);
  const n =
    Math.log(Math.cos(30 * radian) / Math.cos(60 * radian)) /
    Math.log(stretched(60) / stretched(30));
  const scale = (6_370_000 * Math.cos(30 * radian) * stretched(30) ** n) / n;
  const radius = scale / stretched(latitudeDeg) ** n;
  const turn = n * wrapped(longitudeDeg + 97) * radian;
  return [radius * Math.sin(turn), scale / stretched(35) ** n - radius * Math.cos(turn)];
}

const texts = (shapes: readonly Shape[]) =>
  shapes.flatMap((shape) => (shape.kind === "text" ? [shape] : []));

test("title, time and legend stand in their corners", () => {
  const shapes = texts(annotationsOf(PICTURE, FIRST_ANNOTATIONS));
  const title = shapes.find(({ text }) => text === "A storm");
  const time = shapes.find(({ text }) => text === "2013-05-20 20:00Z");
  expect([title?.x, time?.x]).toEqual([10, 10]);
  expect(title?.y).toBeLessThan(30);
  expect(time?.y).toBeGreaterThan(380);
  expect(shapes.find(({ text }) => text === "Rain")?.anchor).toBe("end");
  const none = {
    title: false,
    time: false,
    legend: false,
    scale: false,
    compass: false,
    rings: false,
    marks: false,
  };
  expect(annotationsOf(PICTURE, none)).toEqual([]);
});

test("a legend that is longer than the picture is high goes on beside its first column", () => {
  const legend = ["Cloud", "Rain", "Graupel"].map((name) => ({ name, color: "#112233" }));
  const shapes = annotationsOf(
    { ...PICTURE, legend, inset: { left: 0, top: 300, right: 0, bottom: 60 } },
    { ...FIRST_ANNOTATIONS, title: false, time: false, compass: false },
  );
  const [cloud, rain, graupel] = texts(shapes);
  expect([rain?.x, rain?.y]).toEqual([cloud?.x, (cloud?.y ?? 0) + 15]);
  expect(rain?.y).toBeLessThanOrEqual(340);
  expect(graupel?.y).toBe(cloud?.y);
  expect(graupel?.x).toBeLessThan((cloud?.x ?? 0) - 40);
});

test("letters in a file are as large as in a window, and no text is longer than the picture", () => {
  expect([letterPxOf(1920, 1080), letterPxOf(1000, 620), letterPxOf(390, 844)]).toEqual([
    24, 14, 13,
  ]);
  const text = { kind: "text", y: 0, text: "", strong: false } as const;
  expect(widthForPx({ ...text, x: 13, anchor: "start" }, 390, 13)).toBe(364);
  expect(widthForPx({ ...text, x: 377, anchor: "end" }, 390, 13)).toBe(364);
  expect(widthForPx({ ...text, x: 100, anchor: "middle" }, 390, 13)).toBe(174);
});

test("degrees stand along the horizon where they are", () => {
  const shapes = texts(
    annotationsOf({ ...PICTURE, title: "", time: "", legend: [] }, FIRST_ANNOTATIONS),
  );
  const at = Object.fromEntries(shapes.map(({ text, x }) => [text, x]));
  expect(at.N).toBeCloseTo(400, 3);
  // A tick at 20 degrees from the centre is at tan(20 deg) / tan(30 deg) of the half width.
  expect(at["020°"]).toBeCloseTo(400 + (400 * Math.tan(Math.PI / 9)) / HALF, 3);
  expect(at["340°"]).toBeCloseTo(400 - (400 * Math.tan(Math.PI / 9)) / HALF, 3);
  expect(at.S).toBeUndefined();
});

// Returns a text's box. The letters have the width of common fonts.
function boxOf({ x, y, anchor, text: words }: TextShape, letterPx: number) {
  const widthPx = 0.6 * letterPx * words.length;
  const left = { start: x, middle: x - widthPx / 2, end: x - widthPx }[anchor];
  return { left, right: left + widthPx, top: y - 0.75 * letterPx, bottom: y + 0.2 * letterPx };
}

test("no text lies on another, wherever the horizon is", () => {
  let named = 0;
  for (const [widthPx, heightPx] of [
    [320, 640],
    [390, 844],
    [900, 700],
    [1920, 1080],
  ] as const)
    for (let elevationDeg = -30; elevationDeg <= 30; elevationDeg += 0.25) {
      const [sine, cosine] = [elevationDeg, 90 - elevationDeg].map((deg) =>
        Math.sin((deg * Math.PI) / 180),
      ) as [number, number];
      const half = (HALF * heightPx) / widthPx;
      const projection: Projection = {
        ...NORTH,
        forward: [0, cosine, sine],
        up: [0, -half * sine, half * cosine],
      };
      const inset = { left: 76, top: 106, right: 0, bottom: 88 };
      const picture = { ...PICTURE, widthPx, heightPx, inset, letterPx: 13, projection };
      const shown = texts(annotationsOf(picture, { ...FIRST_ANNOTATIONS, rings: true }));
      named += shown.filter(({ anchor }) => anchor === "middle").length;
      for (const [at, one] of shown.entries())
        for (const other of shown.slice(at + 1)) {
          const [a, b] = [boxOf(one, 13), boxOf(other, 13)];
          const apart =
            a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
          if (!apart)
            expect.fail(
              `${one.text} meets ${other.text} at ${widthPx} px, ${elevationDeg} degrees`,
            );
        }
    }
  // Texts that would overlap are left out, but most azimuths on the horizon must keep their names.
  expect(named / (4 * 241)).toBeGreaterThan(4);
});

test("degrees stand above a horizon that is too low for them and the time", () => {
  const low: Projection = { ...NORTH, forward: [0, 0.97, 0.24], up: [0, -0.07, 0.28] };
  const shapes = annotationsOf({ ...PICTURE, projection: low }, FIRST_ANNOTATIONS);
  const [line] = shapes.flatMap((shape) => (shape.kind === "line" ? [shape.points] : []));
  const north = texts(shapes).find(({ text }) => text === "N");
  expect(north?.y).toBeLessThan(line?.[0]?.[1] ?? 0);
});

// The camera looks along the grid's north. If true north is 10 degrees to the left of the grid's
// north, the camera looks to 10 degrees, and N stands to the left of the picture's middle.
test("degrees on the horizon count from true north", () => {
  const at = (trueNorthDeg: number, name: string) =>
    texts(annotationsOf({ ...PICTURE, trueNorthDeg }, FIRST_ANNOTATIONS)).find(
      ({ text }) => text === name,
    )?.x;
  expect(at(0, "N")).toBeCloseTo(400, 6);
  expect(at(-10, "010°")).toBeCloseTo(400, 6);
  expect(at(-10, "N")).toBeCloseTo(at(0, "350°") ?? 0, 6);
});

test("the scale bar is as long as it says", () => {
  const pose: TopDownPose = { kind: "topDown", centerM: [0, 0], widthM: 160_000 };
  const shapes = annotationsOf(
    { ...PICTURE, pose, legend: [] },
    { ...FIRST_ANNOTATIONS, title: false, time: false },
  );
  const [bar] = shapes.flatMap((shape) => (shape.kind === "line" ? [shape.points] : []));
  const lengthPx = (bar?.[2]?.[0] ?? 0) - (bar?.[1]?.[0] ?? 0);
  expect(texts(shapes).map(({ text }) => text)).toEqual(["20 km"]);
  expect(lengthPx).toBeCloseTo((800 * 20) / 160, 6);
  // Descenders of letters must end above the bar.
  const [words] = texts(shapes);
  expect((words?.y ?? 0) + 0.25 * PICTURE.letterPx).toBeLessThan(bar?.[0]?.[1] ?? 0);
});

test("rings of distance are drawn at their distance", () => {
  const shapes = annotationsOf(PICTURE, { ...FIRST_ANNOTATIONS, compass: false, rings: true });
  const lines = shapes.flatMap((shape) => (shape.kind === "line" ? [shape.points] : []));
  // This is the ring of 10 km, straight ahead. It is 2 m below the eye at a distance of 10 km.
  const ahead = lines[0]?.find(([x]) => Math.abs(x - 400) < 1e-3);
  expect(ahead?.[1]).toBeCloseTo(200 + (200 * 2) / 10_000 / (HALF / 2), 3);
  expect(texts(shapes).map(({ text }) => text)).toContain("10 km");
  const high: Projection = { ...NORTH, eyeM: [0, -80_000, 60_000], forward: [0, 0.8, -0.6] };
  const seen = annotationsOf(
    { ...PICTURE, projection: { ...high, up: [0, 0.17, 0.23] } },
    { ...FIRST_ANNOTATIONS, compass: false, rings: true },
  );
  for (const km of [10, 20, 30, 40, 50])
    expect(texts(seen).map(({ text }) => text)).toContain(`${km} km`);
});

test("lengths are in metres and kilometres, or in feet and nautical miles", () => {
  expect([formatLength(850, "height"), formatLength(8400, "height")]).toEqual(["850 m", "8.4 km"]);
  expect(roundLength(37_000)).toBe(20_000);
  lengthUnits.value = "aviation";
  expect(formatLength(8400, "height")).toBe("27559 ft");
  expect(formatLength(37_040, "distance")).toBe("20 nm");
  expect(roundLength(40_000)).toBe(20 * 1852);
});

test("times in memory are stretches of the time line", () => {
  expect(stretchesOf([], 5)).toEqual([]);
  expect(stretchesOf([0, 2, 3], 5)).toEqual([
    { from: 0, to: 0.125 },
    { from: 0.375, to: 0.875 },
  ]);
  expect(stretchesOf([4, 7], 5)).toEqual([{ from: 0.875, to: 1 }]);
  expect(stretchesOf([0], 1)).toEqual([{ from: 0, to: 1 }]);
});

test("valid times are read with and without a real date", () => {
  expect(momentOf("2013-05-20T20:00:00Z", "", "America/Chicago")).toEqual({
    date: "2013-05-20",
    clock: "20:00Z",
    local: "15:00 CDT",
  });
  expect(momentOf("0001-01-01T00:20:00Z", "", "America/Chicago")).toEqual({
    date: "day 1",
    clock: "00:20Z",
    local: undefined,
  });
  expect(secondsBetween("0001-01-01T00:00:00Z", "0001-01-01T01:20:00Z")).toBe(4800);
  expect(secondsBetween("", "0001-01-01T01:20:00Z")).toBeUndefined();
  expect(zoneOfLongitude(-97.5)).toBe("Etc/GMT+6");
  expect(zoneOfLongitude(11)).toBe("Etc/GMT-1");
});

test("the sun's clock is set in local time for the time that is shown", () => {
  const storm = { dateTime: "2013-05-20T20:00:00Z", latitudeDeg: 35.2, longitudeDeg: -97.4 };
  const here = clockHere(undefined, storm as never, 3600);
  if (here === undefined) throw new Error("there is no clock");
  expect(localClock(here.instant, "America/Chicago")).toBe("16:00 CDT");
  expect(minutesAhead(here.instant, "America/Chicago")).toBe(-300);
  expect(minuteOfDay(here.instant, "America/Chicago")).toBe(960);
  const evening = atMinute(here.instant, 18 * 60 + 30, "America/Chicago");
  expect(evening.toISOString()).toBe("2013-05-20T23:30:00.000Z");
  expect(firstDateTime(evening, 3600)).toBe("2013-05-20T22:30:00Z");
  const { sunrise, sunset } = sunriseAndSunset(here, "America/Chicago");
  // The expected times follow from the declination of that day, 20.0 degrees. The sun's upper edge
  // is on the horizon with 34' of refraction. Noon is at the meridian of the place, 3.5 minutes
  // early by the equation of time. The results are whole minutes.
  const [latitude, declination, edge] = [35.2, 20.0, -0.833].map((deg) => (deg * Math.PI) / 180);
  const cosine =
    (Math.sin(edge ?? 0) - Math.sin(latitude ?? 0) * Math.sin(declination ?? 0)) /
    (Math.cos(latitude ?? 0) * Math.cos(declination ?? 0));
  const halfDay = (Math.acos(cosine) * 720) / Math.PI;
  const noon = 12 * 60 - 300 + 97.4 * 4 - 3.5;
  expect(Math.abs((sunrise ?? 0) - (noon - halfDay))).toBeLessThan(3);
  expect(Math.abs((sunset ?? 0) - (noon + halfDay))).toBeLessThan(3);
  expect(instantOf("0001-01-01T00:20:00Z")).toBeUndefined();
});

test("the map shows the domain and a camera near it, and leads back to the world", () => {
  const domain = { westM: -100_000, eastM: 100_000, southM: -80_000, northM: 80_000 };
  const extent = extentOf(domain, [0, -150_000]);
  expect(extent.southM).toBeLessThan(-150_000);
  expect(extent.eastM - extent.westM).toBeCloseTo(extent.northM - extent.southM, 6);
  expect(extentOf(domain, [0, -9e6])).toEqual(extentOf(domain, undefined));
  const world = worldOfMap(extent, placeOnMap(extent, [12_000, -34_000]));
  expect(world[0]).toBeCloseTo(12_000, 6);
  expect(world[1]).toBeCloseTo(-34_000, 6);
  const [x, y] = placeFrom([1000, 2000], 20_000, 135);
  expect(azimuthTo([1000, 2000], [x, y])).toBeCloseTo(135, 9);
  const orbit: OrbitPose = {
    kind: "orbit",
    targetM: [0, 0, 0],
    azimuthDeg: 90,
    elevationDeg: 60,
    distanceM: 1000,
    fieldOfViewDeg: 35,
  };
  expect(standOf(orbit)?.placeM[0]).toBeCloseTo(500, 6);
});

// The expected places were computed with PROJ (`echo LON LAT | proj STRING`), minus the result for
// the domain's middle. The table is made with lambert() above, so it does not depend on PROJ.
test("places on the map are found by the server's table", () => {
  const middle = { longitudeDeg: -97, latitudeDeg: 35 };
  const world = worldByTable(middle, tableOf(middle, lambert, 10));
  const check = (longitudeDeg: number, latitudeDeg: number, xM: number, yM: number) => {
    const [x, y] = world(longitudeDeg, latitudeDeg) ?? [Number.NaN, Number.NaN];
    expect(Math.hypot(x - xM, y - yM), `${longitudeDeg} ${latitudeDeg}`).toBeLessThan(40);
  };
  check(-97, 35, 0, 0);
  check(-97, 36, 0, 108_986);
  check(-96, 35, 89_405, 558);
  check(-90, 40, 577_712, 567_502);
  check(-90 + 360, 40, 577_712, 567_502);
  expect(world(-97, 46)).toBeUndefined();
  expect(world(83, -35)).toBeUndefined();
});

test("lines on the map are interrupted beyond it and at its cuts", () => {
  const middle = { longitudeDeg: 170, latitudeDeg: 0 };
  // A map that ends at 5 degrees north and is cut at the date line.
  const plain = (longitudeDeg: number, latitudeDeg: number): [number, number] =>
    latitudeDeg > 5 ? [Number.NaN, Number.NaN] : [longitudeDeg * 111_000, latitudeDeg * 111_000];
  const world = worldByTable(middle, tableOf(middle, plain, 20));
  const parts = (line: readonly (readonly number[])[]) => pathOf([line], world).split("M").slice(1);
  const across = parts([
    [178, 0],
    [182, 0],
  ]);
  expect(across).toHaveLength(2);
  const [before, after] = across.map((part) =>
    part.split("L").map((at) => Number(at.split(",")[0])),
  );
  expect(Math.max(...(before ?? []))).toBeLessThan(10.01 * 111_000);
  expect(Math.max(...(after ?? []))).toBeLessThan(-340 * 111_000);
  const [north] = parts([
    [170, 0],
    [170, 9],
  ]);
  const ys = (north ?? "").split("L").map((at) => -Number(at.split(",")[1]));
  expect(Math.max(...ys)).toBeGreaterThan(4 * 111_000);
  expect(Math.max(...ys)).toBeLessThan(5.01 * 111_000);
});

test("a displacement has distance, height and direction", () => {
  const place = (xM: number, yM: number, zM: number) =>
    create(RayPlaceSchema, { position: { xM, yM, zM } });
  const displacement = displacementBetween(place(0, 0, 1000), place(3000, 4000, 3000));
  expect(displacement?.distanceM).toBeCloseTo(5000, 6);
  expect(displacement?.heightM).toBe(2000);
  expect(displacement?.azimuthDeg).toBeCloseTo(36.87, 2);
  expect(displacementBetween(undefined, place(0, 0, 0))).toBeUndefined();
});

test("letters and arrows are one line that is parted again", () => {
  const arrow = arrowStrokes({ left: 0, top: 0 }, { left: 100, top: 0 });
  const same = (a: { left: number; top: number }, b: typeof a) =>
    a.left === b.left && a.top === b.top;
  expect(parted(joined(arrow), same)).toEqual(arrow);
  const words = letterStrokes("Hail 2°", { left: 10, top: 20 }, 12);
  expect(words.length).toBeGreaterThan(7);
  expect(parted(joined(words), same)).toEqual(words);
  for (const { left, top } of words.flat()) {
    expect(left).toBeGreaterThanOrEqual(10);
    expect(top).toBeGreaterThanOrEqual(20);
    expect(top).toBeLessThanOrEqual(32);
  }
  expect(letterStrokes("a", { left: 0, top: 0 }, 12)).toEqual(
    letterStrokes("A", { left: 0, top: 0 }, 12),
  );
  // A session accepts 256 corners.
  const longest = joined(letterStrokes("8".repeat(99), { left: 0, top: 0 }, 12));
  expect(longest.length).toBeLessThanOrEqual(256);
});

test("every parameter of a scene is listed with limits, comment and value, and can be changed", () => {
  const plain = create(SceneSchema);
  const scene = withField(
    withRendering(plain, withTechnique(create(RenderingSchema), "light_volume")),
    Hydrometeor.SNOW,
    { scale: 2 },
  );
  const all = parametersOf(scene);
  const byPath = new Map(all.map((parameter) => [parameter.path, parameter]));
  for (const { fullName, path } of all) expect(COMMENTS[fullName], path).toMatch(/\S{3}/);
  const scale = byPath.get("fields[0].scale");
  const slices = byPath.get("rendering.light_volume.slices");
  const turbidity = byPath.get("sky.turbidity");
  if (scale === undefined || slices === undefined) throw new Error("they are not listed");
  if (turbidity === undefined) throw new Error("it is not listed");
  expect(parameterValue(scene, scale)).toBe(2);
  expect(parameterValue(scene, turbidity)).toBeUndefined();
  const changed = withParameter(withParameter(scene, turbidity, 3), slices, 64);
  expect(parameterValue(changed, turbidity)).toBe(3);
  expect(parameterValue(changed, slices)).toBe(64);
  expect(parameterValue(changed, scale)).toBe(2);
  expect(scene.sky).toBeUndefined();
});

test("B has A's camera, and its own storm, time and settings", () => {
  const a = create(SceneSchema, { stormId: "a", timeIndex: 1, display: { exposureEv: 1 } });
  const size = { widthPx: 300, heightPx: 200 };
  const known = { camera: undefined, size, storm: undefined, other: undefined };
  const kept = create(SceneSchema, { stormId: "a", timeIndex: 0, display: { exposureEv: 5 } });
  const choice = {
    stormId: undefined,
    timeIndex: undefined,
    settings: kept,
    layout: "swipe",
  } as const;
  const b = comparedScene(a, choice, known);
  expect([b.timeIndex, b.display?.exposureEv, b.output?.widthPx]).toEqual([1, 5, 300]);
  const times = (...valid: string[]) =>
    create(StormDescriptionSchema, { times: valid.map((validTime) => ({ validTime })) });
  const run = comparedScene(
    a,
    { ...choice, stormId: "b", settings: undefined },
    { ...known, storm: times("x", "y"), other: times("w", "x", "y") },
  );
  expect([run.stormId, run.timeIndex, run.display?.exposureEv]).toEqual(["b", 2, 1]);
});

test("tools open by their letter and their place", () => {
  expect([toolOfKey("m"), toolOfKey("1"), toolOfKey("7")]).toEqual(["map", "map", "marks"]);
  expect([toolOfKey("8"), toolOfKey("0"), toolOfKey(" ")]).toEqual([
    undefined,
    undefined,
    undefined,
  ]);
});
