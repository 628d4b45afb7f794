// The technique that computes the picture, and its settings.
import { isMessage } from "@bufbuild/protobuf";
import { nameOfPreset, nameOfTechnique } from "../core/names";
import {
  QUALITY_PRESETS,
  type Settings,
  techniqueNameOf,
  withSetting,
  withTechnique,
} from "../core/rendering";
import { withPreset } from "../core/scene";
import type { PageState } from "../core/state";
import { type TechniqueParameter, techniqueParametersOf } from "../core/technique_parameters";
import { type OtherTechnique, OtherTechniqueSchema, Preset } from "../gen/thunderhead/v1/scene_pb";
import type { TechniqueDescription } from "../gen/thunderhead/v1/thunderhead_pb";
import { Choice, NumberInput, Slider, Switch } from "./controls";

export function TechniqueSettings({ state }: { state: PageState }) {
  const settings = state.settings.value;
  const technique = state.technique.value;
  const techniques = state.server.value?.techniques ?? [];
  if (settings === undefined) return null;
  return (
    <>
      <Choice
        label="Technique"
        testId="technique-choice"
        value={techniqueNameOf(settings)}
        options={techniques.map(({ name }) => [name, nameOfTechnique(name)] as const)}
        onChange={(name) => state.editRendering((rendering) => withTechnique(rendering, name))}
      />
      <PapersChoice state={state} />
      {technique !== undefined && (
        <OwnSettings state={state} settings={settings} technique={technique} />
      )}
      {isMessage(settings, OtherTechniqueSchema) && (
        <OtherControls state={state} technique={settings} />
      )}
    </>
  );
}

// The choice of the presets that reproduce the settings of papers.
function PapersChoice({ state }: { state: PageState }) {
  const presets = (state.server.value?.presets ?? [])
    .map(({ preset }) => preset)
    .filter((preset) => !QUALITY_PRESETS.includes(preset));
  const active = state.preset.value;
  return (
    <Choice
      label="Papers' settings"
      testId="papers-choice"
      value={active !== undefined && presets.includes(active) ? active : Preset.UNSPECIFIED}
      options={[Preset.UNSPECIFIED, ...presets].map(
        (preset) => [preset, nameOfPreset(preset)] as const,
      )}
      onChange={(preset) => {
        if (preset !== Preset.UNSPECIFIED) state.edit((scene) => withPreset(scene, preset));
      }}
    />
  );
}

interface OwnProps {
  readonly state: PageState;
  readonly settings: Settings;
  readonly technique: TechniqueDescription;
}

// The settings of the technique that have an effect.
function OwnSettings({ state, settings, technique }: OwnProps) {
  return (
    <>
      {techniqueParametersOf(settings, technique).map((parameter) => (
        <OwnSetting key={parameter.fullName} state={state} parameter={parameter} />
      ))}
    </>
  );
}

function OwnSetting({ state, parameter }: { state: PageState; parameter: TechniqueParameter }) {
  const { kind, name, setting, value } = parameter;
  const common = { label: name, testId: `technique-${parameter.path.replaceAll("_", "-")}` };
  const set = (next: unknown) =>
    state.editRendering((rendering) => withSetting(rendering, setting, next));
  if (kind === "number") {
    return (
      <Slider
        {...common}
        limits={parameter.limits}
        value={(value as number | undefined) ?? parameter.limits.defaultValue}
        afterRest={parameter.slow}
        onChange={set}
      />
    );
  }
  if (kind === "flag") {
    const checked = (value as boolean | undefined) ?? parameter.defaultOn;
    return <Switch {...common} checked={checked} onChange={set} />;
  }
  if (kind !== "choice") return null;
  const options = parameter.options.map((option) => [option.value, option.name] as const);
  return <Choice {...common} value={value as number} options={options} onChange={set} />;
}

interface OtherProps {
  readonly state: PageState;
  readonly technique: OtherTechnique;
}

// The numeric settings of a technique that a server extension provides.
function OtherControls({ state, technique }: OtherProps) {
  return (
    <>
      {Object.entries(technique.numbers).map(([name, value]) => (
        <NumberInput
          key={name}
          label={name}
          value={value}
          testId={`other-${name}`}
          onChange={(next) =>
            state.editSettings({ numbers: { ...technique.numbers, [name]: next } })
          }
        />
      ))}
    </>
  );
}
