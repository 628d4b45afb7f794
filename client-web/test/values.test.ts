import { create, type MessageInitShape, toBinary } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { colorOfHex, hexOfColor } from "../src/core/color";
import { biasInWords, errorSource } from "../src/core/picture_error";
import {
  effectiveField,
  LIMITS,
  MAX_LIGHTS,
  outputSize,
  sceneFromUrlText,
  sceneToUrlText,
  withAsymmetry,
  withDetail,
  withField,
  withFieldSizes,
  withLight,
  withLights,
  withParticleSizes,
  withPreset,
  withStorm,
  withSun,
  withSunClock,
} from "../src/core/scene";
import {
  compassPoint,
  dateTimeOfInput,
  domePointOfSun,
  gridAzimuthDeg,
  inputOfDateTime,
  sunOfDomePoint,
  trueAzimuthDeg,
} from "../src/core/sun";
import {
  displayUnitOf,
  formatBytes,
  formatElapsed,
  formatNumber,
  formatQuantity,
  formatValidTime,
} from "../src/core/units";
import { describePose, describeSun } from "../src/core/words";
import { AccuracyReportSchema } from "../src/gen/thunderhead/v1/frame_pb";
import {
  DirectionalLightSchema,
  FieldParametersSchema,
  Hydrometeor,
  ParticleSizes,
  PhaseFunction_Kind,
  Preset,
  type Scene,
  SceneSchema,
} from "../src/gen/thunderhead/v1/scene_pb";
import { linkTo, readLink } from "../src/view/link";

describe("scenes", () => {
  const scene = create(SceneSchema, {
    stormId: "a",
    sun: { azimuthDeg: 10 },
    fields: [
      { hydrometeor: Hydrometeor.RAIN, scale: 2, phase: { kind: PhaseFunction_Kind.RAYLEIGH } },
    ],
  });

  it("share what did not change and leave the old one alone", () => {
    const after = withSun(scene, { elevationDeg: 5 });
    expect(after.sun).toMatchObject({ azimuthDeg: 10, elevationDeg: 5 });
    expect(after.fields).toBe(scene.fields);
    expect(scene.sun?.elevationDeg).toBeUndefined();
  });

  it("gain lights, change one of them and lose it", () => {
    const light = (azimuthDeg: number) => create(DirectionalLightSchema, { azimuthDeg });
    const two = withLights(scene, [light(10), light(20)]);
    expect(two.lights.map((each) => each.azimuthDeg)).toEqual([10, 20]);
    const changed = withLight(two, 1, { irradiance: 0.5 });
    expect(changed.lights[1]).toMatchObject({ azimuthDeg: 20, irradiance: 0.5 });
    expect(changed.lights[0]).toBe(two.lights[0]);
    const one = withLights(changed, changed.lights.slice(1));
    expect(one.lights.map((each) => each.azimuthDeg)).toEqual([20]);
    expect(withLights(one, changed.lights.slice(1))).toEqual(one);
    expect(scene.lights).toEqual([]);
    expect(MAX_LIGHTS).toBe(4);
    expect(LIMITS.lightElevation).toMatchObject({ minimum: -90, maximum: 90, unit: "deg" });
  });

  it("change one field, and add one that was not listed", () => {
    const after = withField(
      withField(scene, Hydrometeor.RAIN, { visible: false }),
      Hydrometeor.ICE,
      { scale: 3 },
    );
    expect(after.fields.map((f) => [f.hydrometeor, f.visible, f.scale])).toEqual([
      [Hydrometeor.RAIN, false, 2],
      [Hydrometeor.ICE, undefined, 3],
    ]);
    const phase = withAsymmetry(scene, Hydrometeor.RAIN, 0.5).fields[0]?.phase;
    expect(phase).toMatchObject({ kind: PhaseFunction_Kind.RAYLEIGH, asymmetry: 0.5 });
  });

  it("change a field's detail and keep the rest of it", () => {
    const seeded = withDetail(scene, Hydrometeor.RAIN, { seed: 9 });
    const after = withDetail(seeded, Hydrometeor.RAIN, { share: 0.25 });
    expect(after.fields[0]).toMatchObject({ scale: 2, detail: { seed: 9, share: 0.25 } });
    const defaults = create(FieldParametersSchema, { detail: { share: 0.75, wavelengthM: 300 } });
    const detail = { seed: 9, share: 0.25, octaves: 4, wavelengthM: 300 };
    expect(effectiveField(after, Hydrometeor.RAIN, defaults).detail).toMatchObject(detail);
  });

  it("say where particles' sizes come from: a given radius, else the field, else the scene", () => {
    const sizes = (of: Scene) => effectiveField(of, Hydrometeor.RAIN, undefined).sizes;
    const papers = withParticleSizes(scene, ParticleSizes.PAPERS);
    expect(sizes(papers)).toBe(ParticleSizes.PAPERS);
    const model = withFieldSizes(papers, Hydrometeor.RAIN, ParticleSizes.MODEL, 1e-3);
    expect(sizes(model)).toBe(ParticleSizes.MODEL);
    expect(model.fields[0]?.radiusM).toBeUndefined();
    const given = withFieldSizes(papers, Hydrometeor.RAIN, ParticleSizes.GIVEN, 1e-3);
    expect(given.fields[0]?.radiusM).toBe(1e-3);
    expect(sizes(withField(papers, Hydrometeor.RAIN, { radiusM: 1e-4 }))).toBe(ParticleSizes.GIVEN);
    expect(sizes(withParticleSizes(given, ParticleSizes.MODEL))).toBe(ParticleSizes.MODEL);
  });

  it("take the papers' constants with their presets", () => {
    const preset = (chosen: Preset) => withPreset(scene, chosen).particleSizes;
    expect(preset(Preset.PER_FIELD_PHASE_TRANSLUCENT)).toBe(ParticleSizes.PAPERS);
    expect(preset(Preset.BALANCED)).toBe(ParticleSizes.MODEL);
  });

  it("drop what belongs to a storm with the storm", () => {
    const after = withStorm(scene, "b", 3);
    expect(after).toMatchObject({ stormId: "b", timeIndex: 3, camera: undefined, fields: [] });
    expect(after.sun).toBe(scene.sun);
  });

  it("fall back on the storm's settings, then on the schema's", () => {
    const defaults = create(FieldParametersSchema, {
      densityKgPerM3: 500,
      scale: 7,
      phase: { asymmetry: 0.8 },
    });
    const rain = effectiveField(scene, Hydrometeor.RAIN, defaults);
    expect(rain).toMatchObject({ visible: true, scale: 2, albedo: 1, phase: { asymmetry: 0.8 } });
    expect(rain.densityKgPerM3).toBe(500);
    expect(rain.sizes).toBe(ParticleSizes.MODEL);
    expect(rain.radiusM).toBeUndefined();
    expect(effectiveField(scene, Hydrometeor.ICE, undefined).scale).toBe(1);
  });

  it("go into a link and come out the same", () => {
    for (const stormId of ["", "a", "ab", "abc", "Gewitter äöü"]) {
      const sent = create(SceneSchema, { ...scene, stormId });
      const link = linkTo("http://host:1/path/?session=old#x", "s/1", sent);
      const read = readLink(link);
      expect(read.viewerKey).toBe("s/1");
      expect(read.scene && toBinary(SceneSchema, read.scene)).toEqual(toBinary(SceneSchema, sent));
    }
    expect(sceneFromUrlText("not base64!")).toBeUndefined();
    expect(sceneFromUrlText(sceneToUrlText(scene).slice(0, -3))).toBeUndefined();
  });

  it("ask for pictures of the canvas's shape within the limits", () => {
    expect(outputSize(1000, 500, 0.5)).toEqual({ widthPx: 500, heightPx: 250 });
    expect(outputSize(16384, 4096, 1)).toEqual({ widthPx: 8192, heightPx: 2048 });
    expect(outputSize(0, 0, 1)).toEqual({ widthPx: 1, heightPx: 1 });
  });
});

describe("the sky dome", () => {
  it("has the zenith in the middle, north at the top and east at the right", () => {
    const zenith = domePointOfSun({ azimuthDeg: 77, elevationDeg: 90 });
    expect(Math.hypot(zenith.right, zenith.down)).toBeCloseTo(0, 12);
    expect(domePointOfSun({ azimuthDeg: 0, elevationDeg: 0 }).down).toBeLessThan(-0.8);
    expect(domePointOfSun({ azimuthDeg: 90, elevationDeg: 0 }).right).toBeGreaterThan(0.8);
  });

  it("gives back the direction it was given", () => {
    for (const sun of [
      { azimuthDeg: 255, elevationDeg: 35 },
      { azimuthDeg: 10, elevationDeg: -12 },
    ]) {
      const { right, down } = domePointOfSun(sun);
      expect(sunOfDomePoint(right, down).azimuthDeg).toBeCloseTo(sun.azimuthDeg, 9);
      expect(sunOfDomePoint(right, down).elevationDeg).toBeCloseTo(sun.elevationDeg, 9);
    }
  });

  it("names the points of the compass", () => {
    expect([0, 44, 200, 270, -1].map(compassPoint)).toEqual(["N", "NE", "SSW", "W", "N"]);
  });
});

describe("colours", () => {
  it("are encoded as sRGB: linear 0.21586 is the byte 128", () => {
    expect(hexOfColor({ red: 0.2158605, green: 1, blue: 0 })).toBe("#80ff00");
    expect(colorOfHex("#80FF00").red).toBeCloseTo(0.2158605, 6);
    for (const hex of ["#000000", "#0a0b0c", "#12fe80"])
      expect(hexOfColor(colorOfHex(hex))).toBe(hex);
  });
});

describe("the error of a picture", () => {
  const report = (init: MessageInitShape<typeof AccuracyReportSchema>) =>
    create(AccuracyReportSchema, init);
  const measured = report({
    estimatedError: 0.0873,
    measured: true,
    errorLow: 0.0812,
    errorHigh: 0.0941,
    bias: -0.021,
  });

  it("says its interval once it is measured", () => {
    expect(errorSource(measured)).toBe("measured: 8.12 to 9.41 %");
    expect(biasInWords(measured)).toBe("2.1 % too dark");
    expect(biasInWords(report({ measured: true, bias: 0.01 }))).toBe("1 % too bright");
  });

  it("says that it is a table's until then", () => {
    expect(errorSource(report({ estimatedError: 0.2 }))).toBe("from a table, until measured");
    expect(biasInWords(report({ estimatedError: 0.2 }))).toBe("");
  });
});

describe("numbers as people read them", () => {
  it("have three digits", () => {
    expect([0, 0.012345, 1, 12.346, 255.4, 1e-7, 2.5e7].map(formatNumber)).toEqual([
      "0",
      "0.0123",
      "1",
      "12.3",
      "255",
      "1.00e-7",
      "2.50e7",
    ]);
  });

  it("have units that fit their range", () => {
    expect(displayUnitOf(LIMITS.fieldRadius)).toEqual({ factor: 1000, symbol: "mm" });
    expect(formatQuantity(0.001, LIMITS.fieldRadius)).toBe("1 mm");
    expect(formatQuantity(35, LIMITS.sunElevation)).toBe("35°");
    expect(formatQuantity(917, LIMITS.fieldDensity)).toBe("917 kg/m³");
    expect(formatBytes(28_912)).toBe("28.9 kB");
    expect(formatBytes(999)).toBe("999 B");
    expect(formatBytes(999_800)).toBe("1 MB");
  });

  it("tell idealised times from real ones", () => {
    expect(formatValidTime("0001-01-01T00:20:00Z", 0)).toBe("day 1, 00:20");
    expect(formatValidTime("2013-05-20T20:00:30Z", 0)).toBe("2013-05-20 20:00:30 UTC");
    expect(formatElapsed(0)).toBe("+0 min");
    expect(formatElapsed(4800)).toBe("+1 h 20 min");
    expect(formatElapsed(45)).toBe("+45 s");
  });
});

describe("the sun's clock", () => {
  it("goes between the schema's date and an input's", () => {
    expect(inputOfDateTime("2013-05-20T20:00:00Z")).toBe("2013-05-20T20:00:00");
    expect(inputOfDateTime("")).toBe("");
    expect(dateTimeOfInput("2013-05-20T20:00")).toBe("2013-05-20T20:00:00Z");
    expect(dateTimeOfInput("2013-05-20T20:00:30")).toBe("2013-05-20T20:00:30Z");
  });

  it("belongs to the storm", () => {
    const clocked = withSunClock(create(SceneSchema, { stormId: "a" }), { latitudeDeg: 12 });
    expect(clocked.sun?.clock?.latitudeDeg).toBe(12);
    expect(withStorm(clocked, "b", 0).sun?.clock).toBeUndefined();
  });
});

it("says where a spotter stands", () => {
  const pose = {
    kind: "spotter",
    azimuthDeg: 315,
    elevationDeg: 5,
    focalLengthMm: 24,
    eyeHeightM: 1.7,
  } as const;
  expect(describePose({ ...pose, placeM: [14_142, -14_142] }, 0)).toBe(
    "Looks to NW (315°), 5° up, through a lens of 24 mm, from 20 km SE of the middle",
  );
  expect(describePose({ ...pose, placeM: [10, -20] }, 0)).toMatch(/ from the middle$/);
});

// East of a Lambert grid's central meridian, true north is to the left of the grid's north.
it("counts directions from true north", () => {
  const west = -12.5;
  const pose = {
    kind: "spotter",
    azimuthDeg: 315,
    elevationDeg: 5,
    focalLengthMm: 24,
    eyeHeightM: 1.7,
  } as const;
  expect(describePose({ ...pose, placeM: [14_142, -14_142] }, west)).toBe(
    "Looks to NNW (328°), 5° up, through a lens of 24 mm, from 20 km SSE of the middle",
  );
  const orbit = {
    kind: "orbit",
    targetM: [0, 0, 0],
    azimuthDeg: 350,
    elevationDeg: 4,
    distanceM: 61_000,
    fieldOfViewDeg: 35,
  } as const;
  expect(describePose(orbit, west)).toMatch(/^Seen from N \(3°\)/);
  const above = { kind: "topDown", centerM: [0, 0], widthM: 160_000 } as const;
  expect(describePose(above, west)).toBe("160 km from left to right, the grid's north up");
  expect(describePose(above, 0.2)).toBe("160 km from left to right, north up");
  const sun = { azimuthDeg: 260, elevationDeg: 20 };
  expect(describeSun(sun, 0)).toBe("The sun is in W, 20° high");
  expect(describeSun(sun, west)).toBe("The sun is in W, 20° high");
  expect(describeSun(sun, 30)).toBe("The sun is in SW, 20° high");
  expect(gridAzimuthDeg(trueAzimuthDeg(350, west), west)).toBeCloseTo(350, 9);
  expect(trueAzimuthDeg(350, west)).toBeCloseTo(2.5, 9);
});
