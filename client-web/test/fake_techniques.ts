// Test support: the techniques and presets of the fake service, and the defaults that it fills in.
import { create, isMessage, type Message, type MessageInitShape } from "@bufbuild/protobuf";
import {
  hasSetting,
  renderingOf,
  type Settings,
  settingsOf,
  sharedSettingsOf,
  techniqueNameOf,
  withSettings,
} from "../src/core/rendering";
import { ModelledSchema } from "../src/gen/thunderhead/v1/frame_pb";
import {
  CumulusSchema,
  HalfAngleSchema,
  type LightVolume,
  LightVolumeSchema,
  MetaballsSchema,
  OtherTechniqueSchema,
  Preset,
  ReferenceSchema,
  type Rendering,
  type Scene,
  TracedLight,
  Transport,
} from "../src/gen/thunderhead/v1/scene_pb";
import {
  PresetDescriptionSchema,
  type TechniqueDescription,
  TechniqueDescriptionSchema,
} from "../src/gen/thunderhead/v1/thunderhead_pb";

const MEDIUM = { slices: 128, thetaFDeg: 20, perFieldPhase: true, falseColors: false };

// The transports that volume techniques accept.
const TRANSPORTS = [
  Transport.CONSISTENT,
  Transport.LOW_ALBEDO,
  Transport.PAPER,
  Transport.PAPER_LOW_ALBEDO,
] as const;

const TOY = create(OtherTechniqueSchema, { name: "toy", numbers: { haze: 0.5 } });

// Each technique with the settings whose defaults are not in the schema.
const DEFAULTS: readonly Settings[] = [
  create(LightVolumeSchema, {
    ...MEDIUM,
    transport: Transport.DIFFUSION,
    detail: true,
    tracedLight: TracedLight.AT_REST,
  }),
  create(HalfAngleSchema, { ...MEDIUM, transport: Transport.CONSISTENT, detail: false }),
  create(MetaballsSchema, {
    transport: Transport.CONSISTENT,
    thetaFDeg: 20,
    perFieldPhase: true,
    falseColors: false,
    isotropic: false,
  }),
  create(CumulusSchema),
  create(ReferenceSchema, { perFieldPhase: true, falseColors: false }),
  TOY,
];

const CAPABILITIES: Readonly<Record<string, Partial<Omit<TechniqueDescription, keyof Message>>>> = {
  [LightVolumeSchema.typeName]: {
    showsDetail: true,
    showsFieldOptics: true,
    showsTracedLight: true,
    hasSlices: true,
    drawsImages: true,
    transports: [Transport.DIFFUSION, ...TRANSPORTS],
  },
  [HalfAngleSchema.typeName]: {
    showsDetail: true,
    showsFieldOptics: true,
    hasSlices: true,
    drawsImages: true,
    transports: [...TRANSPORTS],
  },
  [MetaballsSchema.typeName]: {
    showsLights: true,
    showsFieldOptics: true,
    drawsImages: true,
    transports: [Transport.CONSISTENT, Transport.LOW_ALBEDO, Transport.PAPER],
  },
  [CumulusSchema.typeName]: { drawsImages: true },
  [ReferenceSchema.typeName]: { showsLights: true, showsFieldOptics: true },
  [OtherTechniqueSchema.typeName]: { drawsImages: true },
};

export const FAKE_TECHNIQUES: TechniqueDescription[] = DEFAULTS.map((settings) =>
  create(TechniqueDescriptionSchema, {
    ...CAPABILITIES[settings.$typeName],
    name: techniqueNameOf(settings),
  }),
);

function preset(name: Preset, settings: MessageInitShape<typeof LightVolumeSchema>) {
  const all = create(LightVolumeSchema, { ...(DEFAULTS[0] as LightVolume), ...settings });
  return create(PresetDescriptionSchema, { preset: name, rendering: renderingOf(all) });
}

const PAPER = { transport: Transport.CONSISTENT, tracedLight: TracedLight.OFF } as const;

export const FAKE_PRESETS = [
  preset(Preset.FAST, { detail: false, slices: 64, tracedLight: TracedLight.OFF }),
  preset(Preset.BALANCED, {}),
  preset(Preset.ACCURATE, { tracedLight: TracedLight.AWAITED }),
  preset(Preset.UNIFORM_PHASE_LOW_ALBEDO, {
    ...PAPER,
    transport: Transport.LOW_ALBEDO,
    perFieldPhase: false,
    detail: false,
  }),
  preset(Preset.UNIFORM_PHASE_TRANSLUCENT, { ...PAPER, perFieldPhase: false, detail: false }),
  preset(Preset.PER_FIELD_PHASE_TRANSLUCENT, { ...PAPER, detail: false }),
  preset(Preset.PER_FIELD_PHASE_DETAIL_TRANSLUCENT, PAPER),
];

// Fills in defaults, as the server does for a scene's rendering.
export function completeRendering(rendering: Rendering | undefined): Rendering {
  const technique = rendering?.technique;
  if (technique?.case === undefined || technique.case === "preset") {
    const asked = technique?.value ?? Preset.BALANCED;
    const found = FAKE_PRESETS.find((each) => each.preset === asked)?.rendering;
    if (found === undefined) throw new Error(`no preset ${asked}`);
    return found;
  }
  const given = technique.value;
  const defaults = DEFAULTS.find((settings) => settings.$typeName === given.$typeName);
  if (isMessage(given, OtherTechniqueSchema)) {
    const numbers = { ...TOY.numbers, ...given.numbers };
    return renderingOf(create(OtherTechniqueSchema, { ...TOY, numbers }));
  }
  const set = Object.entries(given).filter(([, value]) => value !== undefined && value !== 0);
  const settings = { ...defaults, ...Object.fromEntries(set) } as Message as Settings;
  const { transport, tracedLight } = sharedSettingsOf(given);
  const untraced = transport && transport !== Transport.DIFFUSION && !tracedLight;
  return withSettings(
    renderingOf(settings),
    untraced && hasSetting(settings, "tracedLight") ? { tracedLight: TracedLight.OFF } : {},
  );
}

export function modelledOf(scene: Scene) {
  const settings = settingsOf(scene.rendering);
  if (settings === undefined) throw new Error("the scene was not completed");
  return create(ModelledSchema, {
    slices: sharedSettingsOf(settings).slices ?? 0,
    occupiedShare: 0.25,
    technique: techniqueNameOf(settings),
  });
}

export function tracesLight(scene: Scene): boolean {
  const { tracedLight, transport } = sharedSettingsOf(settingsOf(scene.rendering));
  return transport === Transport.DIFFUSION && tracedLight !== TracedLight.OFF;
}
