// Tests of edge cases: runs without a common time, days without a sunrise, texts that do not fit
// into a mark.
import { create } from "@bufbuild/protobuf";
import { expect, test } from "vitest";
import { awayInWords, type ComparisonChoice, timeOfB } from "../src/core/comparison";
import { joined, leftOutInWords, letterStrokes, MAX_LETTERS, parted } from "../src/core/lettering";
import type { StrokePoint } from "../src/core/stroke";
import { dayInWords, sunHeightsDeg } from "../src/core/sun_clock";
import { SceneSchema } from "../src/gen/thunderhead/v1/scene_pb";
import { type StormDescription, StormDescriptionSchema } from "../src/gen/thunderhead/v1/storm_pb";

const run = (...valid: string[]): StormDescription =>
  create(StormDescriptionSchema, { times: valid.map((validTime) => ({ validTime })) });
const EARLY = run("2020-05-20T00:00:00Z", "2020-05-20T06:00:00Z", "2020-05-20T07:00:00Z");
const CHOICE: ComparisonChoice = {
  stormId: "b",
  timeIndex: undefined,
  settings: undefined,
  layout: "swipe",
};

const ofB = (timeIndex: number, other: StormDescription | undefined, storm = EARLY) =>
  timeOfB(create(SceneSchema, { stormId: "a", timeIndex }), CHOICE, { storm, other });

test("B shows the nearest valid time where it has not A's, and says how far away it is", () => {
  const later = run("2020-05-20T05:00:00Z", "2020-05-20T06:20:00Z", "2020-05-20T09:00:00Z");
  const near = ofB(1, later);
  expect(near).toEqual({ index: 1, awayS: 1200 });
  expect(awayInWords(near)).toContain("the nearest one, 20 min later");
  expect(ofB(0, later)).toEqual({ index: 0, awayS: 18_000 });
  const exact = ofB(2, run("2020-05-20T07:00:00Z"));
  expect(exact).toEqual({ index: 0, awayS: 0 });
  expect(awayInWords(exact)).toBeUndefined();
});

test("an idealised run and a real one have no time in common: B shows the same number and says so", () => {
  const idealised = run("0001-01-01T00:20:00Z", "0001-01-01T00:40:00Z");
  const far = ofB(2, idealised);
  expect(far).toEqual({ index: 1, awayS: undefined });
  expect(awayInWords(far)).toContain("same number");
  expect(
    timeOfB(create(SceneSchema, { timeIndex: 2 }), { ...CHOICE, timeIndex: 1 }, {} as never),
  ).toEqual({ index: 1, awayS: 0 });
});

const dayAt = (date: string, latitudeDeg: number, longitudeDeg = 25) => ({
  instant: new Date(date),
  latitudeDeg,
  longitudeDeg,
});

test("the polar day has no sunset and no night, the polar night no sunrise", () => {
  const summer = dayAt("2020-06-21T10:00:00Z", 70);
  expect(dayInWords(summer, "Europe/Helsinki")).toBe("The sun does not set");
  expect(Math.min(...sunHeightsDeg(summer, "Europe/Helsinki", 48))).toBeGreaterThan(0);
  const winter = dayAt("2020-12-21T10:00:00Z", 70);
  expect(dayInWords(winter, "Europe/Helsinki")).toBe("The sun does not rise");
  expect(Math.max(...sunHeightsDeg(winter, "Europe/Helsinki", 48))).toBeLessThan(0);
});

test("a day whose sun sets after midnight is light from then on until midnight", () => {
  // Fairbanks uses a time zone far east of its solar time.
  const here = dayAt("2020-06-21T20:00:00Z", 64.8, -147.7);
  const zone = "America/Anchorage";
  expect(dayInWords(here, zone)).toMatch(/^Sunrise 02:\d\d · sunset 00:\d\d$/);
  const heights = sunHeightsDeg(here, zone, 48);
  expect(heights).toHaveLength(49);
  expect(heights[0]).toBeGreaterThan(0);
  expect(heights[3]).toBeLessThan(0);
  expect(Math.min(...heights.slice(7))).toBeGreaterThan(0);
});

const ORIGIN = { left: 0, top: 0 };
const written = (words: string) => letterStrokes(words, ORIGIN, 12);

test("German words and the signs of a forecast are written in full", () => {
  for (const sign of "ÄÖÜäöüß()%=+°°./'") {
    expect(written(sign).length, sign).toBeGreaterThan(0);
    expect(leftOutInWords(sign), sign).toBeUndefined();
  }
  // No stroke may be a single point, because that repeats a corner, and a repeated corner lifts the
  // pen.
  const same = (a: StrokePoint, b: StrokePoint) => a.left === b.left && a.top === b.top;
  for (const sign of "?!:.,ÄÖÜ°%")
    expect(parted(joined(written(sign)), same).length, sign).toBe(written(sign).length);
  expect(written("Ö")).not.toEqual(written("O"));
  expect(written("ß")).toEqual(written("SS"));
  expect(written("é")).toEqual(written("E"));
});

test("what no mark can hold is said, and the rest keeps within what the session takes", () => {
  expect(leftOutInWords("hail ☂ 2 cm ☂")).toBe("Cannot be written: ☂");
  expect(written("A☂B")).toEqual(written("AB"));
  const longest = "8".repeat(MAX_LETTERS);
  const corners = joined(written(longest)).length;
  expect(corners).toBeLessThanOrEqual(256);
  expect(corners).toBeGreaterThan(200);
  expect(leftOutInWords(longest)).toMatch(/^Too long for one mark, left out: 8+$/);
  expect(leftOutInWords("Überschießender Wolkenturm")).toBeUndefined();
});
