import { describe, expect, it } from "vitest";
import {
  clampToLimits,
  defaultChoiceOf,
  defaultNumberOf,
  defaultOnOf,
  limitsOf,
  positionOfValue,
  valueAtPosition,
} from "../src/core/limits";
import { DEFAULTS, LIMITS } from "../src/core/scene";
import {
  FieldParametersSchema,
  LightVolumeSchema,
  PositionSchema,
  SceneSchema,
  SunSchema,
  ToneMap,
} from "../src/gen/thunderhead/v1/scene_pb";

const SLICES = limitsOf(LightVolumeSchema.field.slices);

describe("limits come from the schema", () => {
  it("reads range, default, unit and scale of a number", () => {
    expect(SLICES).toEqual({
      minimum: 1,
      maximum: 4096,
      defaultValue: 128,
      unit: "1",
      logarithmic: true,
      integer: true,
      singlePrecision: false,
    });
    expect(LIMITS.sunAzimuth).toMatchObject({ minimum: -360, maximum: 360, unit: "deg" });
  });

  it("reads the defaults of switches and choices", () => {
    expect(DEFAULTS.visible).toBe(true);
    expect(DEFAULTS.rings).toBe(false);
    expect(DEFAULTS.borders).toBe(false);
    expect(DEFAULTS.toneMap).toBe(ToneMap.FILMIC);
    expect(defaultChoiceOf(SunSchema.field.source)).toBe(0);
    expect(() => defaultOnOf(SceneSchema.field.timeIndex)).toThrow("no default");
    expect(() => defaultNumberOf(LIMITS.exposure)).toThrow("no default");
  });

  it("tells a default from none", () => {
    expect(LIMITS.turbidity.defaultValue).toBe(1.5);
    expect(LIMITS.exposure.defaultValue).toBeUndefined();
    expect(limitsOf(FieldParametersSchema.field.radiusM).defaultValue).toBeUndefined();
    expect(limitsOf(PositionSchema.field.xM).defaultValue).toBeUndefined();
  });

  it("refuses a field without limits", () => {
    expect(() => limitsOf(SceneSchema.field.stormId)).toThrow(/storm_id/);
  });
});

describe("clamping", () => {
  it("keeps a 32-bit float from rounding to outside of its limits", () => {
    // The 32-bit floats nearest to 0.99 and -0.99 lie outside the limits.
    for (const value of [0.99, -0.99, 5, -5]) {
      const sent = Math.fround(clampToLimits(value, LIMITS.phaseAsymmetry));
      expect(Math.abs(sent)).toBeLessThanOrEqual(0.99);
      expect(Math.abs(sent)).toBeGreaterThan(0.9899999);
    }
    const radius = Math.fround(clampToLimits(0, LIMITS.fieldRadius));
    expect(radius).toBeGreaterThanOrEqual(1e-7);
    expect(radius).toBeLessThan(1.0001e-7);
  });

  it("answers what is no number with the default", () => {
    expect(clampToLimits(Number.NaN, SLICES)).toBe(128);
  });
});

describe("slider positions", () => {
  it("moves evenly in the logarithm where the schema says so", () => {
    expect(positionOfValue(64, SLICES)).toBeCloseTo(0.5, 12);
    expect(valueAtPosition(0.5, SLICES)).toBe(64);
  });

  it("reaches both ends exactly, also where a logarithmic range begins at zero", () => {
    for (const limits of [...Object.values(LIMITS), SLICES]) {
      expect(valueAtPosition(0, limits)).toBeCloseTo(limits.minimum, 6);
      const end = valueAtPosition(1, limits);
      expect(Math.abs(end - limits.maximum)).toBeLessThanOrEqual(1e-6 * limits.maximum);
    }
    expect(valueAtPosition(0, LIMITS.fieldScale)).toBe(0);
    expect(positionOfValue(0, LIMITS.fieldScale)).toBe(0);
  });

  it("gives back the position it came from, to three digits of the value", () => {
    for (const limits of [...Object.values(LIMITS), SLICES]) {
      for (const position of [0.1, 0.35, 0.5, 0.77, 0.99]) {
        const value = valueAtPosition(position, limits);
        // An integer may differ by half a step from the slider's position.
        const halfStep = limits.logarithmic ? 0.06 : 0.5 / (limits.maximum - limits.minimum);
        const tolerance = 0.005 + (limits.integer ? halfStep : 0);
        expect(Math.abs(positionOfValue(value, limits) - position)).toBeLessThan(tolerance);
      }
    }
  });

  it("rises with its position", () => {
    for (const limits of [...Object.values(LIMITS), SLICES]) {
      let before = valueAtPosition(0, limits);
      for (let step = 1; step <= 40; step += 1) {
        const value = valueAtPosition(step / 40, limits);
        expect(value).toBeGreaterThanOrEqual(before);
        before = value;
      }
    }
  });
});
