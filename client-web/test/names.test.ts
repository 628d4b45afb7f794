import { describe, expect, it } from "vitest";
import { nameOfHydrometeor, namesOfPhases } from "../src/core/names";
import {
  type Hydrometeor,
  HydrometeorSchema,
  PhaseFunction_Kind,
} from "../src/gen/thunderhead/v1/scene_pb";

describe("names of enumerators", () => {
  it("are their words, in the schema's order", () => {
    const names = HydrometeorSchema.values.slice(1).map(({ number }) => nameOfHydrometeor(number));
    expect(names).toEqual(["Cloud", "Rain", "Ice", "Snow", "Graupel", "Hail"]);
    expect(nameOfHydrometeor(99 as Hydrometeor)).toBe("Hydrometeor 99");
  });

  it("of phase functions are people's names or what they are of, each once", () => {
    const names = new Map(namesOfPhases());
    expect(names.get(PhaseFunction_Kind.HENYEY_GREENSTEIN)).toBe("Henyey–Greenstein");
    expect(names.get(PhaseFunction_Kind.ICE_COLUMNS)).toBe("Ice columns");
    expect(names.get(PhaseFunction_Kind.UNSPECIFIED)).toBeUndefined();
    expect(new Set(names.values()).size).toBe(8);
  });
});
