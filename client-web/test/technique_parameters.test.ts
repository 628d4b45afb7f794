import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import {
  renderingOf,
  type Settings,
  settingsOf,
  techniqueNameOf,
  withSetting,
} from "../src/core/rendering";
import { techniqueParametersOf } from "../src/core/technique_parameters";
import {
  CumulusSchema,
  HalfAngleSchema,
  LightVolumeSchema,
  MetaballsSchema,
  OtherTechniqueSchema,
  ReferenceSchema,
  Cumulus_Source as Source,
  TracedLight,
  Transport,
} from "../src/gen/thunderhead/v1/scene_pb";
import { TechniqueDescriptionSchema } from "../src/gen/thunderhead/v1/thunderhead_pb";
import { FAKE_TECHNIQUES } from "./fake_techniques";

function parametersOf(settings: Settings) {
  const name = techniqueNameOf(settings);
  const technique =
    FAKE_TECHNIQUES.find((each) => each.name === name) ??
    create(TechniqueDescriptionSchema, { name });
  return techniqueParametersOf(settings, technique);
}

function namesOf(settings: Settings): string[] {
  return parametersOf(settings).map(({ setting }) => setting);
}

describe("the settings that a technique shows", () => {
  it("are all of its message that have an effect", () => {
    const own = ["source", "seed", "scales", "leastExtinctionPerM", "corona", "trap"];
    expect(namesOf(create(CumulusSchema))).toEqual([
      ...own,
      "transmission",
      "roughness",
      "component",
    ]);
    const cauliflower = create(CumulusSchema, { source: Source.CAULIFLOWER });
    expect(namesOf(cauliflower)).not.toContain("leastExtinctionPerM");
    expect(namesOf(create(ReferenceSchema))).toEqual(["perFieldPhase", "falseColors"]);
    expect(namesOf(create(MetaballsSchema))).not.toContain("albedo");
    expect(namesOf(create(MetaballsSchema, { transport: Transport.PAPER }))).toContain("albedo");
    expect(namesOf(create(LightVolumeSchema))).toContain("tracedLight");
    const paper = create(LightVolumeSchema, { transport: Transport.PAPER });
    expect(namesOf(paper)).not.toContain("tracedLight");
    expect(namesOf(create(OtherTechniqueSchema, { name: "fog", numbers: { depth: 1 } }))).toEqual(
      [],
    );
  });

  it("are left out where the server's technique cannot show them", () => {
    const settings = create(HalfAngleSchema);
    const blind = create(TechniqueDescriptionSchema, { name: techniqueNameOf(settings) });
    const names = techniqueParametersOf(settings, blind).map(({ setting }) => setting);
    expect(names).toEqual(["transport", "thetaFDeg"]);
  });

  it("have the value that an absent field stands for", () => {
    const source = parametersOf(create(CumulusSchema))[0];
    expect(source?.value).toBe(Source.STORM);
    expect(source?.kind === "choice" && source.options.map(({ name }) => name)).toEqual([
      "The storm's cloud and ice",
      "Cauliflower",
      "Fair-weather cumulus",
      "Congestus",
      "Field of cumulus",
      "One ellipsoid",
    ]);
    const transport = parametersOf(create(LightVolumeSchema))[0];
    expect(transport?.name).toBe("Transport");
    expect(transport?.value).toBe(Transport.DIFFUSION);
    const slices = parametersOf(create(HalfAngleSchema))[1];
    expect(slices?.kind === "number" && slices.limits.defaultValue).toBe(128);
  });

  it("change one at a time, and the transport resets what depends on it", () => {
    const before = renderingOf(create(LightVolumeSchema, { tracedLight: TracedLight.OFF }));
    expect(settingsOf(withSetting(before, "slices", 7))).toMatchObject({
      slices: 7,
      tracedLight: TracedLight.OFF,
    });
    expect(settingsOf(withSetting(before, "transport", Transport.PAPER))).toMatchObject({
      transport: Transport.PAPER,
      tracedLight: TracedLight.UNSPECIFIED,
    });
  });
});
