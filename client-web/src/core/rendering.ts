// Reads and changes Scene.rendering, which is either a technique with its settings or a preset that
// stands for a technique with settings. The names of the settings come from the technique's
// Protobuf message.
import {
  create,
  type DescField,
  type DescMessage,
  equals,
  isMessage,
  type Message,
} from "@bufbuild/protobuf";
import {
  type Cumulus,
  type LightVolume,
  type Metaballs,
  type OtherTechnique,
  OtherTechniqueSchema,
  Preset,
  type Rendering,
  RenderingSchema,
  TracedLight,
  Transport,
} from "../gen/thunderhead/v1/scene_pb";
import type { PresetDescription, TechniqueDescription } from "../gen/thunderhead/v1/thunderhead_pb";
import { defaultChoiceOf, defaultOnOf } from "./limits";

// The settings message of a technique.
export type Settings = Exclude<Rendering["technique"]["value"], Preset | undefined>;

type FieldsOf<T extends Message> = Omit<T, keyof Message>;

// Settings that several techniques share. A setting is undefined if it has the technique's default,
// or if the technique does not have it.
export type SharedSettings = Partial<FieldsOf<LightVolume>>;

export type SettingsChange = SharedSettings &
  Partial<FieldsOf<Metaballs>> &
  Partial<FieldsOf<Cumulus>> &
  Partial<FieldsOf<OtherTechnique>>;

// The quality presets, which trade speed for accuracy, fastest first. The other presets reproduce
// the settings of papers.
export const QUALITY_PRESETS: readonly Preset[] = [Preset.FAST, Preset.BALANCED, Preset.ACCURATE];

const TECHNIQUES: readonly (DescField & { readonly message: DescMessage })[] =
  RenderingSchema.fields.flatMap((field) => (field.fieldKind === "message" ? [field] : []));

// Settings that are kept when the technique changes. The other settings are reset, because their
// defaults differ between techniques.
const KEPT = ["slices", "thetaFDeg", "perFieldPhase", "falseColors"] as const;

function fieldOf(settings: Settings) {
  return TECHNIQUES.find((field) => field.message.typeName === settings.$typeName);
}

// Returns the descriptor of the settings' message.
export function descriptorOf(settings: Settings): DescMessage {
  const field = fieldOf(settings);
  if (field === undefined) throw new Error(`${settings.$typeName} is no technique's message`);
  return field.message;
}

// Returns the technique's settings; undefined for a preset.
export function settingsOf(rendering: Rendering | undefined): Settings | undefined {
  const value = rendering?.technique.value;
  return typeof value === "object" ? value : undefined;
}

export function sharedSettingsOf(settings: Settings | undefined): SharedSettings {
  return (settings ?? {}) as SharedSettings;
}

export function renderingOf(settings: Settings): Rendering {
  const technique = { case: fieldOf(settings)?.localName, value: settings };
  return { ...create(RenderingSchema), technique: technique as Rendering["technique"] };
}

// Returns the technique's name, as in TechniqueDescription.
export function techniqueNameOf(settings: Settings): string {
  if (isMessage(settings, OtherTechniqueSchema)) return settings.name;
  return fieldOf(settings)?.name ?? "";
}

export function hasSetting(settings: Settings, name: keyof SharedSettings): boolean {
  return fieldOf(settings)?.message.field[name] !== undefined;
}

// Returns whether a switch of the technique is on; false if the technique does not have the
// setting.
export function isSettingOn(
  settings: Settings,
  name: "detail" | "falseColors" | "perFieldPhase",
): boolean {
  const field = fieldOf(settings)?.message.field[name];
  return field !== undefined && (sharedSettingsOf(settings)[name] ?? defaultOnOf(field));
}

// Returns the transport; undefined for a technique without a choice of transport.
export function transportOf(
  settings: Settings,
  technique: TechniqueDescription | undefined,
): Transport | undefined {
  const given = sharedSettingsOf(settings).transport || technique?.transports[0];
  if (given) return given;
  const field = fieldOf(settings)?.message.field.transport;
  return field === undefined ? undefined : defaultChoiceOf(field);
}

// Returns true if the setting `traced_light` has an effect.
export function tracesLight(settings: Settings, technique: TechniqueDescription): boolean {
  return (
    technique.showsTracedLight &&
    hasSetting(settings, "tracedLight") &&
    transportOf(settings, technique) === Transport.DIFFUSION
  );
}

// Returns true if the picture shows the fields' turbulent detail.
export function drawsDetail(settings: Settings, technique: TechniqueDescription): boolean {
  const asked = !hasSetting(settings, "detail") || isSettingOn(settings, "detail");
  return technique.showsDetail && asked;
}

// Returns true if the picture shows the fields' false colours.
export function drawsFalseColors(settings: Settings, technique: TechniqueDescription): boolean {
  return technique.showsFieldOptics && isSettingOn(settings, "falseColors");
}

export function withSettings(rendering: Rendering, change: SettingsChange): Rendering {
  const settings = settingsOf(rendering);
  return settings === undefined ? rendering : renderingOf({ ...settings, ...change } as Settings);
}

// Changes the transport. Also clears `traced_light`, so that the server decides when to trace
// paths, because path tracing does not correct every transport.
export function withTransport(rendering: Rendering, transport: Transport): Rendering {
  const settings = settingsOf(rendering);
  const traces = settings !== undefined && hasSetting(settings, "tracedLight");
  const rest = traces ? { tracedLight: TracedLight.UNSPECIFIED } : {};
  return withSettings(rendering, { transport, ...rest });
}

// Changes one setting of the technique.
export function withSetting(rendering: Rendering, setting: string, value: unknown): Rendering {
  if (setting === "transport") return withTransport(rendering, value as Transport);
  return withSettings(rendering, { [setting]: value });
}

// Changes the technique. Keeps the settings listed in KEPT that both techniques have. The server
// fills in the other settings.
export function withTechnique(rendering: Rendering, name: string): Rendering {
  const field = TECHNIQUES.find((other) => other.name === name);
  if (field === undefined) return renderingOf(create(OtherTechniqueSchema, { name }));
  const old = sharedSettingsOf(settingsOf(rendering));
  const kept = KEPT.filter((key) => old[key] !== undefined && key in field.message.field);
  const settings = {
    ...create(field.message),
    ...Object.fromEntries(kept.map((key) => [key, old[key]])),
  };
  return renderingOf(settings as Message as Settings);
}

export function renderingOfPreset(preset: Preset): Rendering {
  return create(RenderingSchema, { technique: { case: "preset", value: preset } });
}

// Replaces a preset by the technique and settings that it stands for. Returns undefined if the
// server has not sent them.
export function resolved(
  rendering: Rendering | undefined,
  presets: readonly PresetDescription[],
): Rendering | undefined {
  if (rendering?.technique.case !== "preset") return rendering;
  const { value } = rendering.technique;
  return presets.find(({ preset }) => preset === value)?.rendering;
}

// Returns the preset with exactly this technique and these settings, if there is one.
export function presetOf(
  rendering: Rendering | undefined,
  presets: readonly PresetDescription[],
): Preset | undefined {
  const plain = resolved(rendering, presets);
  if (plain === undefined) return undefined;
  return presets.find(
    (each) => each.rendering !== undefined && equals(RenderingSchema, each.rendering, plain),
  )?.preset;
}
