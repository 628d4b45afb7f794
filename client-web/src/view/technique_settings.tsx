// The technique that computes the picture, and its settings.
import { isMessage } from "@bufbuild/protobuf";
import { nameOfPreset, nameOfTechnique, nameOfTracedLight, nameOfTransport } from "../core/names";
import {
  hasSetting,
  isSettingOn,
  QUALITY_PRESETS,
  type Settings,
  type SharedSettings,
  settingLimits,
  sharedSettingsOf,
  techniqueNameOf,
  tracesLight,
  transportOf,
  withTechnique,
  withTransport,
} from "../core/rendering";
import { DEFAULTS, withPreset } from "../core/scene";
import type { PageState } from "../core/state";
import {
  CumulusSchema,
  MetaballsSchema,
  type OtherTechnique,
  OtherTechniqueSchema,
  Preset,
  TracedLight,
} from "../gen/thunderhead/v1/scene_pb";
import type { TechniqueDescription } from "../gen/thunderhead/v1/thunderhead_pb";
import { Choice, NumberInput, Slider, Switch } from "./controls";
import { CumulusControls } from "./cumulus_controls";
import { MetaballControls } from "./metaball_controls";

const TRACED_LIGHTS = [TracedLight.OFF, TracedLight.AT_REST, TracedLight.AWAITED].map(
  (tracedLight) => [tracedLight, nameOfTracedLight(tracedLight)] as const,
);

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
        <MediumControls state={state} settings={settings} technique={technique} />
      )}
      {isMessage(settings, MetaballsSchema) && (
        <MetaballControls state={state} metaballs={settings} technique={technique} />
      )}
      {isMessage(settings, CumulusSchema) && <CumulusControls state={state} cumulus={settings} />}
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

interface MediumProps {
  readonly state: PageState;
  readonly settings: Settings;
  readonly technique: TechniqueDescription;
}

// The settings that several techniques share. Settings that this technique does not have are left
// out.
function MediumControls({ state, settings, technique }: MediumProps) {
  const shared = sharedSettingsOf(settings);
  const transport = transportOf(settings, technique);
  const flag = (name: "perFieldPhase" | "detail" | "falseColors", label: string, testId: string) =>
    hasSetting(settings, name) && (
      <Switch
        label={label}
        testId={testId}
        checked={isSettingOn(settings, name)}
        onChange={(checked) => state.editSettings({ [name]: checked })}
      />
    );
  return (
    <>
      {transport !== undefined && (
        <Choice
          label="Transport"
          testId="transport"
          value={transport}
          options={technique.transports.map((each) => [each, nameOfTransport(each)] as const)}
          onChange={(chosen) =>
            state.editRendering((rendering) => withTransport(rendering, chosen))
          }
        />
      )}
      {tracesLight(settings, technique) && (
        <Choice
          label="Traced light"
          testId="traced-light"
          value={shared.tracedLight || DEFAULTS.tracedLight}
          options={TRACED_LIGHTS}
          onChange={(tracedLight) => state.editSettings({ tracedLight })}
        />
      )}
      {technique.hasSlices && (
        <SettingSlider state={state} settings={settings} name="slices" label="Slices" />
      )}
      <SettingSlider state={state} settings={settings} name="thetaFDeg" label="Forward angle θf" />
      {technique.showsFieldOptics &&
        flag("perFieldPhase", "Phase function per field", "per-field-phase")}
      {technique.showsDetail && flag("detail", "Detail finer than the grid", "detail")}
      {technique.showsFieldOptics && flag("falseColors", "False colours", "false-colors")}
    </>
  );
}

interface SettingSliderProps {
  readonly state: PageState;
  readonly settings: Settings;
  readonly name: keyof SharedSettings & ("slices" | "thetaFDeg");
  readonly label: string;
}

// A slider for a setting; empty if the technique does not have the setting.
function SettingSlider({ state, settings, name, label }: SettingSliderProps) {
  const limits = settingLimits(settings, name);
  if (limits === undefined) return null;
  return (
    <Slider
      label={label}
      limits={limits}
      value={sharedSettingsOf(settings)[name] ?? limits.defaultValue}
      testId={name === "slices" ? "slices" : "theta-f"}
      onChange={(value) => state.editSettings({ [name]: value })}
    />
  );
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
