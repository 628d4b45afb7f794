import { create, equals, fromBinary, isMessage, toBinary } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { nameOfPreset, nameOfStage, nameOfTechnique, nameOfTransport } from "../src/core/names";
import {
  drawsDetail,
  drawsFalseColors,
  hasSetting,
  isSettingOn,
  presetOf,
  renderingOf,
  renderingOfPreset,
  resolved,
  type Settings,
  settingsOf,
  sharedSettingsOf,
  techniqueNameOf,
  tracesLight,
  transportOf,
  withSettings,
  withTechnique,
  withTransport,
} from "../src/core/rendering";
import { withPreset, withRendering } from "../src/core/scene";
import { PageState } from "../src/core/state";
import { FrameSchema, Stage } from "../src/gen/thunderhead/v1/frame_pb";
import {
  AccuracySchema,
  CumulusSchema,
  HalfAngleSchema,
  LightVolumeSchema,
  MetaballsSchema,
  OtherTechniqueSchema,
  Preset,
  ReferenceSchema,
  type Rendering,
  RenderingSchema,
  SceneSchema,
  TracedLight,
  Transport,
} from "../src/gen/thunderhead/v1/scene_pb";
import {
  GetServerInfoResponseSchema,
  type TechniqueDescription,
  TechniqueDescriptionSchema,
} from "../src/gen/thunderhead/v1/thunderhead_pb";
import { completeRendering, FAKE_PRESETS, FAKE_TECHNIQUES } from "./fake_techniques";

const NAME = {
  lightVolume: techniqueNameOf(create(LightVolumeSchema)),
  halfAngle: techniqueNameOf(create(HalfAngleSchema)),
  metaballs: techniqueNameOf(create(MetaballsSchema)),
  cumulus: techniqueNameOf(create(CumulusSchema)),
  reference: techniqueNameOf(create(ReferenceSchema)),
};

const balanced = completeRendering(undefined);

function mustSettings(rendering: Rendering): Settings {
  const settings = settingsOf(rendering);
  if (settings === undefined) throw new Error("no settings");
  return settings;
}

function described(settings: Settings): TechniqueDescription {
  const found = FAKE_TECHNIQUES.find(({ name }) => name === techniqueNameOf(settings));
  if (found === undefined) throw new Error(`no technique ${techniqueNameOf(settings)}`);
  return found;
}

function overTheWire(rendering: Rendering): Rendering {
  return fromBinary(RenderingSchema, toBinary(RenderingSchema, rendering));
}

describe("presets", () => {
  it("are known by technique and settings, each by its own", () => {
    for (const { preset, rendering } of FAKE_PRESETS) {
      expect(presetOf(rendering, FAKE_PRESETS)).toBe(preset);
      expect(presetOf(rendering && overTheWire(rendering), FAKE_PRESETS)).toBe(preset);
      expect(presetOf(renderingOfPreset(preset), FAKE_PRESETS)).toBe(preset);
    }
  });

  it("are left by any change, and found again by the way back", () => {
    for (const change of [
      { slices: 129 },
      { thetaFDeg: 20.5 },
      { detail: false },
      { falseColors: true },
      { perFieldPhase: false },
      { transport: Transport.PAPER },
    ]) {
      expect(presetOf(withSettings(balanced, change), FAKE_PRESETS)).toBeUndefined();
    }
    const away = withSettings(balanced, { slices: 200, detail: false });
    expect(presetOf(withSettings(away, { slices: 128, detail: true }), FAKE_PRESETS)).toBe(
      Preset.BALANCED,
    );
    expect(presetOf(withTechnique(balanced, NAME.halfAngle), FAKE_PRESETS)).toBeUndefined();
  });

  it("are not guessed before the server has told of them", () => {
    expect(presetOf(balanced, [])).toBeUndefined();
    expect(resolved(renderingOfPreset(Preset.FAST), [])).toBeUndefined();
    expect(presetOf(undefined, FAKE_PRESETS)).toBeUndefined();
  });

  it("are sent by name, and drop the accuracy that would have the server choose instead", () => {
    const accuracy = create(AccuracySchema, { limit: { case: "maxError", value: 0.5 } });
    const scene = withPreset(create(SceneSchema, { rendering: balanced, accuracy }), Preset.FAST);
    expect(scene.rendering?.technique).toEqual({ case: "preset", value: Preset.FAST });
    expect(scene.accuracy).toBeUndefined();
  });
});

describe("another technique", () => {
  it("keeps what both have and leaves the rest to its own defaults", () => {
    const before = withSettings(balanced, {
      slices: 77,
      falseColors: true,
      perFieldPhase: false,
      thetaFDeg: 10,
    });
    const halfAngle = mustSettings(withTechnique(before, NAME.halfAngle));
    expect(isMessage(halfAngle, HalfAngleSchema)).toBe(true);
    const kept = { falseColors: true, perFieldPhase: false, thetaFDeg: 10 };
    const shared = sharedSettingsOf(halfAngle);
    expect(shared).toMatchObject({ slices: 77, ...kept });
    // These settings are not kept. Half-angle slices do not support diffusion, and have no detail
    // by default.
    expect(shared.transport).toBe(Transport.UNSPECIFIED);
    expect(shared.detail).toBeUndefined();
    const expected = create(HalfAngleSchema, { slices: 77, ...kept });
    expect(equals(HalfAngleSchema, halfAngle as typeof expected, expected)).toBe(true);

    const metaballs = mustSettings(withTechnique(before, NAME.metaballs));
    expect(metaballs).toMatchObject({ $typeName: MetaballsSchema.typeName, ...kept });
    expect("slices" in metaballs).toBe(false);
    const cumulus = withTechnique(before, NAME.cumulus);
    expect(equals(RenderingSchema, cumulus, renderingOf(create(CumulusSchema)))).toBe(true);
  });

  it("and back is the first again, where nothing was changed", () => {
    for (const name of Object.values(NAME)) {
      const there = completeRendering(withTechnique(balanced, name));
      expect(techniqueNameOf(mustSettings(there))).toBe(name);
      const back = completeRendering(withTechnique(there, NAME.lightVolume));
      expect(presetOf(back, FAKE_PRESETS)).toBe(Preset.BALANCED);
    }
  });

  it("that the schema has no message for goes by its name", () => {
    const toy = mustSettings(withTechnique(balanced, "toy"));
    expect(toy).toMatchObject({ $typeName: OtherTechniqueSchema.typeName, name: "toy" });
    expect(techniqueNameOf(toy)).toBe("toy");
    const changed = withSettings(renderingOf(toy), { numbers: { haze: 0.25 } });
    expect(settingsOf(overTheWire(changed))).toMatchObject({
      name: "toy",
      numbers: { haze: 0.25 },
    });
  });
});

describe("a technique's settings", () => {
  it("are those of its message", () => {
    const has = (settings: Settings) =>
      (["slices", "detail", "falseColors", "tracedLight", "thetaFDeg"] as const).filter((name) =>
        hasSetting(settings, name),
      );
    expect(has(create(LightVolumeSchema))).toEqual([
      "slices",
      "detail",
      "falseColors",
      "tracedLight",
      "thetaFDeg",
    ]);
    expect(has(create(HalfAngleSchema))).not.toContain("tracedLight");
    expect(has(create(MetaballsSchema))).toEqual(["falseColors", "thetaFDeg"]);
    expect(has(create(ReferenceSchema))).toEqual(["falseColors"]);
    expect(has(create(CumulusSchema))).toEqual([]);
    expect(has(create(OtherTechniqueSchema))).toEqual([]);
  });

  it("have the transport that is given, or else the technique's default", () => {
    const given = create(HalfAngleSchema, { transport: Transport.PAPER });
    expect(transportOf(given, described(given))).toBe(Transport.PAPER);
    const open = create(HalfAngleSchema);
    const transports = [Transport.LOW_ALBEDO, Transport.CONSISTENT];
    const technique = create(TechniqueDescriptionSchema, { transports });
    expect(transportOf(open, technique)).toBe(Transport.LOW_ALBEDO);
    expect(transportOf(open, undefined)).toBe(Transport.CONSISTENT);
    const cumulus = create(CumulusSchema);
    expect(transportOf(cumulus, described(cumulus))).toBeUndefined();
  });

  it("are on as the messages say where they are absent", () => {
    const [volume, slices] = [create(LightVolumeSchema), create(HalfAngleSchema)];
    expect(isSettingOn(volume, "detail")).toBe(true);
    expect(isSettingOn(slices, "detail")).toBe(false);
    expect(isSettingOn(slices, "perFieldPhase")).toBe(true);
    expect(isSettingOn({ ...slices, perFieldPhase: false }, "perFieldPhase")).toBe(false);
    expect(isSettingOn(create(CumulusSchema), "falseColors")).toBe(false);
  });

  it("of the path-traced correction follow the transport", () => {
    const consistent = withTransport(balanced, Transport.CONSISTENT);
    expect(settingsOf(consistent)).toMatchObject({
      transport: Transport.CONSISTENT,
      tracedLight: TracedLight.UNSPECIFIED,
      slices: 128,
    });
    expect(sharedSettingsOf(settingsOf(completeRendering(consistent))).tracedLight).toBe(
      TracedLight.OFF,
    );
    const back = completeRendering(withTransport(consistent, Transport.DIFFUSION));
    expect(presetOf(back, FAKE_PRESETS)).toBe(Preset.BALANCED);
    const halfAngle = withTransport(withTechnique(balanced, NAME.halfAngle), Transport.PAPER);
    expect("tracedLight" in mustSettings(halfAngle)).toBe(false);
  });

  it("take no part in the picture where the technique does not show them", () => {
    const settings = create(LightVolumeSchema, { detail: true, falseColors: true });
    const technique = described(settings);
    expect(drawsDetail(settings, technique)).toBe(true);
    expect(drawsFalseColors(settings, technique)).toBe(true);
    expect(tracesLight(settings, technique)).toBe(true);
    const blind = create(TechniqueDescriptionSchema, { name: technique.name });
    expect(drawsDetail(settings, blind)).toBe(false);
    expect(drawsFalseColors(settings, blind)).toBe(false);
    expect(tracesLight(settings, blind)).toBe(false);
    const plain = create(LightVolumeSchema, { transport: Transport.CONSISTENT, detail: false });
    expect(drawsDetail(plain, technique)).toBe(false);
    expect(drawsFalseColors(plain, technique)).toBe(false);
    expect(tracesLight(plain, technique)).toBe(false);
  });
});

describe("the page's rendering", () => {
  const server = create(GetServerInfoResponseSchema, {
    techniques: FAKE_TECHNIQUES,
    presets: FAKE_PRESETS,
  });

  function stateWith(rendering: Rendering | undefined): PageState {
    const state = new PageState();
    state.server.value = server;
    state.adoptScene(withRendering(create(SceneSchema), rendering));
    return state;
  }

  it("is the preset's until a setting changes, which makes it the user's own", () => {
    const state = stateWith(balanced);
    expect(state.preset.value).toBe(Preset.BALANCED);
    state.edit((scene) => withPreset(scene, Preset.FAST));
    expect(state.preset.value).toBe(Preset.FAST);
    expect(state.settings.value).toMatchObject({ slices: 64, detail: false });
    expect(state.detailShown.value).toBe(false);

    state.editSettings({ detail: true });
    expect(state.preset.value).toBeUndefined();
    expect(state.detailShown.value).toBe(true);
    expect(state.scene.value.rendering?.technique).toMatchObject({
      case: "lightVolume",
      value: { slices: 64, detail: true, tracedLight: TracedLight.OFF },
    });
  });

  it("is completed by what the server made of it", () => {
    const state = stateWith(balanced);
    state.editRendering((rendering) => withTechnique(rendering, NAME.reference));
    state.adoptCompleted({
      ...state.scene.value,
      rendering: completeRendering(state.scene.value.rendering),
    });
    expect(state.settings.value).toMatchObject({ perFieldPhase: true, falseColors: false });
    expect(state.technique.value).toMatchObject({ showsLights: true, drawsImages: false });
    // Setting the same rendering again does not change the scene, so no control is rendered again.
    const { value } = state.scene;
    state.adoptCompleted({
      ...state.scene.value,
      rendering: completeRendering(state.scene.value.rendering),
    });
    expect(state.scene.value).toBe(value);
  });

  it("gives way to the server's choice while an accuracy is asked for", () => {
    const state = stateWith(balanced);
    const accuracy = create(AccuracySchema, { limit: { case: "maxError", value: 0.5 } });
    state.edit((scene) => ({ ...scene, accuracy }));
    expect(state.preset.value).toBeUndefined();
    expect(state.drawnTechnique.value?.name).toBe(NAME.lightVolume);
    const rendering = renderingOf(create(MetaballsSchema, { falseColors: true }));
    state.showFrame(create(FrameSchema, { accuracy: { rendering } }));
    expect(state.drawnTechnique.value?.name).toBe(NAME.metaballs);
    expect(state.falseColorsShown.value).toBe(true);
    expect(state.detailShown.value).toBe(false);
    // The controls still show the scene's own technique, which draws again without the goal.
    expect(state.technique.value?.name).toBe(NAME.lightVolume);
    state.edit((scene) => ({ ...scene, accuracy: undefined }));
    expect(state.drawnTechnique.value?.name).toBe(NAME.lightVolume);
    expect(state.preset.value).toBe(Preset.BALANCED);
  });

  it("is not edited before the server has told of it", () => {
    const state = new PageState();
    const edits: unknown[] = [];
    state.onEdit((scene) => edits.push(scene));
    state.editSettings({ slices: 12 });
    expect(edits).toEqual([]);
  });
});

describe("names", () => {
  it("are people's for all that the schema knows, and the raw one for others", () => {
    for (const name of Object.values(NAME)) expect(nameOfTechnique(name)).not.toBe(name);
    expect(nameOfTechnique("toy")).toBe("toy");
    expect(nameOfTechnique("other")).toBe("other");
    expect(nameOfStage(Stage.READ_BACK)).toBe("Read back");
    expect(nameOfStage(99 as Stage)).toBe("Stage 99");
    expect(nameOfPreset(99 as Preset)).toBe("Preset 99");
    expect(nameOfTransport(99 as Transport)).toBe("Transport 99");
  });
});
