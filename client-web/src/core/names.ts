// Display names of enum values and techniques.

import type { DescEnum } from "@bufbuild/protobuf";
import { Stage } from "../gen/thunderhead/v1/frame_pb";
import {
  Cumulus_Component as Component,
  Cumulus_ComponentSchema as ComponentSchema,
  CumulusSchema,
  HalfAngleSchema,
  type Hydrometeor,
  HydrometeorSchema,
  LightVolumeSchema,
  MetaballsSchema,
  PhaseFunction_Kind as PhaseKind,
  PhaseFunction_KindSchema as PhaseKindSchema,
  Preset,
  ReferenceSchema,
  RenderingSchema,
  Cumulus_Source as Source,
  Cumulus_SourceSchema as SourceSchema,
  TracedLight,
  TracedLightSchema,
  Transport,
  TransportSchema,
} from "../gen/thunderhead/v1/scene_pb";

// Returns a name like "ice columns" for "ICE_COLUMNS"; undefined if the value is unknown.
export function enumeratorInWords(description: DescEnum, value: number): string | undefined {
  return description.value[value]?.localName.toLowerCase().replaceAll("_", " ");
}

function nameOfEnumerator(description: DescEnum, value: number): string {
  const words = enumeratorInWords(description, value);
  return words ? (words[0]?.toUpperCase() ?? "") + words.slice(1) : `${description.name} ${value}`;
}

export function nameOfHydrometeor(hydrometeor: Hydrometeor): string {
  return nameOfEnumerator(HydrometeorSchema, hydrometeor);
}

// Names that differ from those of their enumerators.
const PHASE_NAMES: Readonly<Partial<Record<PhaseKind, string>>> = {
  [PhaseKind.HENYEY_GREENSTEIN]: "Henyey–Greenstein",
  [PhaseKind.CORNETTE_SHANKS]: "Cornette–Shanks",
  [PhaseKind.ICE_ROUGH]: "Rough ice",
  [PhaseKind.WATER_NARROW]: "Water droplets, all of 5 µm",
};

// Returns each phase function with its name.
export function namesOfPhases(): [PhaseKind, string][] {
  return PhaseKindSchema.values
    .map(({ number }): PhaseKind => number)
    .filter((kind) => kind !== PhaseKind.UNSPECIFIED)
    .map((kind) => [kind, PHASE_NAMES[kind] ?? nameOfEnumerator(PhaseKindSchema, kind)]);
}

const TECHNIQUE_NAMES: Readonly<Record<string, string>> = {
  [LightVolumeSchema.typeName]: "Light volume",
  [HalfAngleSchema.typeName]: "Half-angle slices",
  [MetaballsSchema.typeName]: "Metaballs",
  [CumulusSchema.typeName]: "Cumulus surface",
  [ReferenceSchema.typeName]: "Monte Carlo reference",
};

// Returns a technique's display name. Pass TechniqueDescription.name as `name`. A technique of a
// server extension has no other name, so `name` is returned.
export function nameOfTechnique(name: string): string {
  const field = RenderingSchema.fields.find((each) => each.name === name);
  return TECHNIQUE_NAMES[field?.message?.typeName ?? ""] ?? name;
}

const TRANSPORT_NAMES: Readonly<Record<Transport, string>> = {
  [Transport.UNSPECIFIED]: "Default",
  [Transport.DIFFUSION]: "Diffusion",
  [Transport.CONSISTENT]: "Consistent",
  [Transport.LOW_ALBEDO]: "Single scattering",
  [Transport.PAPER]: "As in the paper",
  [Transport.PAPER_LOW_ALBEDO]: "Single scattering, as in the paper",
};

export function nameOfTransport(transport: Transport): string {
  return TRANSPORT_NAMES[transport] ?? `Transport ${transport}`;
}

// Names of a technique's choices that differ from those of their enumerators, by enumeration.
const CHOICE_NAMES: Readonly<Record<string, Readonly<Record<number, string>>>> = {
  [TransportSchema.typeName]: TRANSPORT_NAMES,
  [TracedLightSchema.typeName]: { [TracedLight.AWAITED]: "At rest; files wait for it" },
  [SourceSchema.typeName]: {
    [Source.STORM]: "The storm's cloud and ice",
    [Source.FAIR_WEATHER_CUMULUS]: "Fair-weather cumulus",
    [Source.CUMULUS_FIELD]: "Field of cumulus",
    [Source.ELLIPSOID]: "One ellipsoid",
  },
  [ComponentSchema.typeName]: {
    [Component.DIRECT]: "Direct sunlight",
    [Component.INTER_REFLECTION]: "Inter-reflection",
    [Component.AMBIENT]: "Sky and ground",
    [Component.BALLS]: "Bare ellipsoids",
  },
};

export function nameOfChoice(choice: DescEnum, value: number): string {
  return CHOICE_NAMES[choice.typeName]?.[value] ?? nameOfEnumerator(choice, value);
}

const PRESET_NAMES: Readonly<Record<Preset, string>> = {
  [Preset.UNSPECIFIED]: "None",
  [Preset.FAST]: "Fast",
  [Preset.BALANCED]: "Balanced",
  [Preset.ACCURATE]: "Accurate",
  [Preset.UNIFORM_PHASE_LOW_ALBEDO]: "Uniform phase, low albedo",
  [Preset.UNIFORM_PHASE_TRANSLUCENT]: "Uniform phase, translucent",
  [Preset.PER_FIELD_PHASE_TRANSLUCENT]: "Phase per field, translucent",
  [Preset.PER_FIELD_PHASE_DETAIL_TRANSLUCENT]: "Phase per field, detail, translucent",
};

export function nameOfPreset(preset: Preset): string {
  return PRESET_NAMES[preset] ?? `Preset ${preset}`;
}

const STAGE_NAMES: Readonly<Record<Stage, string>> = {
  [Stage.UNSPECIFIED]: "Other",
  [Stage.READ]: "Read file",
  [Stage.EXTINCTION]: "Extinction",
  [Stage.UPLOAD]: "Upload",
  [Stage.FIT]: "Fit metaballs",
  [Stage.SURFACE]: "Surface",
  [Stage.SLICES]: "Slices",
  [Stage.LIGHT]: "Light",
  [Stage.VIEW]: "View",
  [Stage.GROUND]: "Ground",
  [Stage.AIR]: "Air",
  [Stage.COMPOSITE]: "Sky and ground",
  [Stage.TRACE]: "Traced so far",
  [Stage.CORRECTION]: "Light correction",
  [Stage.TONE]: "Tone map",
  [Stage.READ_BACK]: "Read back",
  [Stage.ENCODE]: "Encode",
};

export function nameOfStage(stage: Stage): string {
  return STAGE_NAMES[stage] ?? `Stage ${stage}`;
}
