// Controls for the accuracy or speed that the server must reach. They also show the server's report
// on the picture that is shown: technique and settings, their cost, and the estimated error.
import { create, isMessage } from "@bufbuild/protobuf";
import { nameOfTechnique, nameOfTransport } from "../core/names";
import { biasInWords, errorSource } from "../core/picture_error";
import {
  hasSetting,
  type Settings,
  settingsOf,
  sharedSettingsOf,
  techniqueNameOf,
  transportOf,
} from "../core/rendering";
import { LIMITS, withAccuracy } from "../core/scene";
import type { PageState } from "../core/state";
import { formatNumber } from "../core/units";
import type { AccuracyReport } from "../gen/thunderhead/v1/frame_pb";
import { type Accuracy, AccuracySchema, MetaballsSchema } from "../gen/thunderhead/v1/scene_pb";
import type { TechniqueDescription } from "../gen/thunderhead/v1/thunderhead_pb";
import { Choice, Section, Slider } from "./controls";

type Goal = "none" | "maxError" | "maxMilliseconds";

const GOALS = [
  ["none", "Same as the quality"],
  ["maxError", "At most this error"],
  ["maxMilliseconds", "At most this time per frame"],
] as const;

// Initial values of the two sliders: a relative error (0.5 is 50 %) that every view can reach, and
// a time per frame that still gives smooth motion.
const FIRST_ERROR = 0.5;
const FIRST_MILLISECONDS = 100;

function accuracyOf(goal: Goal): Accuracy | undefined {
  switch (goal) {
    case "maxError":
      return create(AccuracySchema, { limit: { case: "maxError", value: FIRST_ERROR } });
    case "maxMilliseconds":
      return create(AccuracySchema, {
        limit: { case: "maxMilliseconds", value: FIRST_MILLISECONDS },
      });
    case "none":
      return undefined;
  }
}

export function AccuracySection({ state }: { state: PageState }) {
  const limit = state.accuracy.value?.limit;
  const report = state.frame.value?.accuracy;
  const set = (accuracy: Accuracy | undefined) =>
    state.edit((scene) => withAccuracy(scene, accuracy));
  return (
    <Section title="Accuracy" testId="accuracy-section">
      <Choice<Goal>
        label="Goal"
        testId="accuracy-goal"
        value={limit?.case ?? "none"}
        options={GOALS}
        onChange={(goal) => set(accuracyOf(goal))}
      />
      {limit?.case === "maxError" && (
        <Slider
          label="Error"
          limits={LIMITS.maxError}
          value={limit.value}
          testId="max-error"
          onChange={(value) => set(create(AccuracySchema, { limit: { case: "maxError", value } }))}
        />
      )}
      {limit?.case === "maxMilliseconds" && (
        <Slider
          label="Time"
          limits={LIMITS.maxMilliseconds}
          value={limit.value}
          testId="max-milliseconds"
          onChange={(value) =>
            set(create(AccuracySchema, { limit: { case: "maxMilliseconds", value } }))
          }
        />
      )}
      {report !== undefined && <Report state={state} report={report} />}
    </Section>
  );
}

interface ReportProps {
  readonly state: PageState;
  readonly report: AccuracyReport;
}

function Report({ state, report }: ReportProps) {
  const { hasSlices } = drawnBy(state, report);
  const source = report.measured
    ? `${errorSource(report)}, ${biasInWords(report)} on the whole`
    : errorSource(report);
  return (
    <>
      <p
        class="quiet"
        data-testid="accuracy-report"
        data-estimated-error={report.estimatedError}
        data-measured={report.measured}
        data-discretisation-error={report.discretisationError}
        data-slices={report.slices}
        data-has-slices={hasSlices}
        data-expected-milliseconds={report.expectedMilliseconds}
      >
        {report.measured ? "Measured" : "Estimated"} error {percent(report.estimatedError)} (
        {source}){report.imageScale !== 1 && ` at ${percent(report.imageScale)} of the size`}
        {report.expectedMilliseconds !== undefined &&
          `; ${formatNumber(report.expectedMilliseconds)} ms a full frame`}
        .
      </p>
      {report.unmet !== undefined && (
        <p class="unmet" role="status" data-testid="accuracy-unmet">
          {report.unmet.message}.
        </p>
      )}
    </>
  );
}

function drawnBy(state: PageState, report: AccuracyReport) {
  const settings = settingsOf(report.rendering);
  const name = settings === undefined ? "" : techniqueNameOf(settings);
  const technique = state.server.value?.techniques.find((each) => each.name === name);
  return { settings, name, technique, hasSlices: technique?.hasSlices ?? false };
}

// Describes in technical terms how the picture was drawn, and the parts of its error.
export function DrawnBy({ state }: { state: PageState }) {
  const report = state.frame.value?.accuracy;
  if (report === undefined) return null;
  const { settings, name, technique, hasSlices } = drawnBy(state, report);
  const words = [nameOfTechnique(name), ...settingsInWords(settings, technique)];
  if ((state.frame.value?.modelled?.tracedPaths ?? 0n) > 0n) words.push("path-traced correction");
  if (hasSlices) words.push(`${report.slices} slices`);
  if (settings !== undefined && isMessage(settings, MetaballsSchema))
    words.push(`${report.slices} balls`);
  const parts: string[] = [];
  if (!report.measured) parts.push(`light model ${percent(report.modelError)}`);
  if (!report.measured && report.discretisationError !== undefined)
    parts.push(`few slices ${percent(report.discretisationError)}`);
  return (
    <p class="quiet" data-testid="drawn-by">
      Drawn by {words.join(", ").toLowerCase()}
      {parts.length > 0 && `; error of the ${parts.join(", of ")}`}.
    </p>
  );
}

// Lists the settings that determine the error, in a few words each.
function settingsInWords(
  settings: Settings | undefined,
  technique: TechniqueDescription | undefined,
): string[] {
  if (settings === undefined) return [];
  const shared = sharedSettingsOf(settings);
  const transport = transportOf(settings, technique);
  return [
    transport !== undefined && nameOfTransport(transport),
    hasSetting(settings, "perFieldPhase") && !shared.perFieldPhase && "one phase function",
    shared.detail === true && "detail",
    shared.falseColors === true && "false colours",
  ].filter((words) => words !== false);
}

function percent(share: number): string {
  return `${formatNumber(100 * share)} %`;
}
