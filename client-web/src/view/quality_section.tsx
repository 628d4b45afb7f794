// The picture's quality: three presets, and the technique with its settings.
import { nameOfPreset } from "../core/names";
import { withPreset } from "../core/scene";
import type { PageState } from "../core/state";
import { Preset } from "../gen/thunderhead/v1/scene_pb";
import { DrawnBy } from "./accuracy_section";
import { Section, Segments } from "./controls";
import { TechniqueSettings } from "./technique_settings";

const QUALITIES = [
  [Preset.FAST, nameOfPreset(Preset.FAST), "Fewer samples and no fine detail."],
  [
    Preset.BALANCED,
    nameOfPreset(Preset.BALANCED),
    "Fine detail; path-traced correction while it rests.",
  ],
  [
    Preset.ACCURATE,
    nameOfPreset(Preset.ACCURATE),
    "Four times the samples of Balanced; files wait for the path-traced correction.",
  ],
] as const;

export function QualityControls({ state }: { state: PageState }) {
  return (
    <>
      <Segments
        label="Picture quality"
        testId="quality-choice"
        value={state.preset.value}
        options={QUALITIES}
        otherwise={otherwise(state)}
        onChange={(chosen) => state.edit((scene) => withPreset(scene, chosen))}
      />
      <NotShown state={state} />
    </>
  );
}

// The section with the modes of papers and every setting of the technique.
export function TechniqueSection({ state }: { state: PageState }) {
  return (
    <Section title="Technique, and the papers' modes" testId="technique-settings">
      <DrawnBy state={state} />
      <TechniqueSettings state={state} />
    </Section>
  );
}

// Returns the text that is shown while none of the three presets is chosen.
function otherwise(state: PageState): string {
  if (state.goal.value !== undefined) return "Set by the goal under Accuracy.";
  if (state.settings.value === undefined) return "Waiting for the server …";
  const preset = state.preset.value;
  return preset === undefined
    ? "Custom: as set below."
    : `As in the paper: ${nameOfPreset(preset)}.`;
}

// Lists the properties of the scene that the picture on the screen leaves out.
function NotShown({ state }: { state: PageState }) {
  const notShown = state.frame.value?.modelled?.notShown ?? [];
  if (notShown.length === 0) return null;
  return (
    <p class="quiet" data-testid="not-shown">
      Not shown: {notShown.map(({ message }) => message).join(", ")}.
    </p>
  );
}
