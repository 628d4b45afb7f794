// The tool "Look". It sets quality, colours, exposure, detail and annotations. It also shows how
// accurate the picture is and which effects it leaves out.
import type { AnnotationChoice } from "../../core/annotations";
import { hasSetting, isSettingOn } from "../../core/rendering";
import type { PageState } from "../../core/state";
import { AccuracySection } from "../accuracy_section";
import { Section, Segments, Switch } from "../controls";
import type { Page } from "../page";
import { ExposureControls, PictureSection } from "../picture_section";
import { QualityControls, TechniqueSection } from "../quality_section";

export function LookTool({ page }: { page: Page }) {
  const { state } = page;
  return (
    <>
      <QualityControls state={state} />
      <AccuracySection state={state} />
      <Colours state={state} />
      <ExposureControls state={state} />
      <OverThePicture state={state} />
      <PictureSection page={page} />
      <TechniqueSection state={state} />
    </>
  );
}

const COLOURS = [
  ["photograph", "Photograph", "As the storm would look in the sky."],
  ["false", "False colours", "Each field in a colour of its own, with a legend."],
] as const;

// Shows only the choices that the technique can draw.
function Colours({ state }: { state: PageState }) {
  const settings = state.settings.value;
  const technique = state.technique.value;
  if (settings === undefined || technique === undefined) return null;
  const hasColours = technique.showsFieldOptics && hasSetting(settings, "falseColors");
  const hasDetail = technique.showsDetail && hasSetting(settings, "detail");
  return (
    <>
      {hasColours && (
        <Segments
          label="Colours"
          testId="colours"
          value={isSettingOn(settings, "falseColors") ? "false" : "photograph"}
          options={COLOURS}
          otherwise=""
          onChange={(chosen) => state.editSettings({ falseColors: chosen === "false" })}
        />
      )}
      {hasDetail && (
        <Switch
          label="Detail finer than the model's grid"
          testId="look-detail"
          checked={isSettingOn(settings, "detail")}
          onChange={(detail) => state.editSettings({ detail })}
        />
      )}
    </>
  );
}

const OVERLAYS: readonly (readonly [keyof AnnotationChoice, string])[] = [
  ["title", "Storm and run (only in saved files)"],
  ["time", "Valid time"],
  ["legend", "Legend of false colours"],
  ["scale", "Scale bar"],
  ["compass", "Degrees along the horizon, from the ground"],
  ["rings", "Rings of distance"],
  ["marks", "Marks (only in saved files)"],
];

function OverThePicture({ state }: { state: PageState }) {
  const chosen = state.annotations.value;
  return (
    <Section title="Over the picture" testId="overlay-section">
      {OVERLAYS.map(([name, label]) => (
        <Switch
          key={name}
          label={label}
          testId={`overlay-${name}`}
          checked={chosen[name]}
          onChange={(shown) => {
            state.annotations.value = { ...chosen, [name]: shown };
          }}
        />
      ))}
    </Section>
  );
}
