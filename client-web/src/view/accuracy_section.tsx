// What accuracy or speed the server is to reach, and what it says of the picture shown: which setting it picked,
// what that costs, and how far from the truth the picture is believed to be.
import { create } from "@bufbuild/protobuf";
import { LIMITS, withAccuracy } from "../core/scene";
import type { PageState } from "../core/state";
import { formatNumber } from "../core/units";
import { type Accuracy, AccuracySchema, Renderer, Transport } from "../gen/thunderhead/v1/scene_pb";
import type { AccuracyReport } from "../gen/thunderhead/v1/thunderhead_pb";
import { Choice, Section, Slider } from "./controls";

type Goal = "none" | "maxError" | "maxMilliseconds";

const GOALS = [
  ["none", "As set below"],
  ["maxError", "At most this error"],
  ["maxMilliseconds", "At most this time a frame"],
] as const;

// Where the sliders begin: a goal that every view of the tables reaches, and a frame that moves smoothly.
const FIRST_ERROR = 0.5;
const FIRST_MILLISECONDS = 100;

// The reference has no setting to be picked, and says itself how far it has come.
const RENDERER_NAMES: Readonly<Partial<Record<Renderer, string>>> = {
  [Renderer.LIGHT_VOLUME]: "light volume",
  [Renderer.HALF_ANGLE]: "half-angle slices",
  [Renderer.METABALL]: "metaballs",
  [Renderer.CUMULUS]: "cumulus surface",
};

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
      {report !== undefined && (
        <Report report={report} traced={(state.frame.value?.modelled?.tracedPaths ?? 0n) > 0n} />
      )}
    </Section>
  );
}

function Report({ report, traced }: { report: AccuracyReport; traced: boolean }) {
  const parts = [`light model ${percent(report.modelError)}`];
  if (report.discretisationError !== undefined) {
    parts.push(`few slices ${percent(report.discretisationError)}`);
  }
  return (
    <>
      <p
        class="quiet"
        data-testid="accuracy-report"
        data-estimated-error={report.estimatedError}
        data-discretisation-error={report.discretisationError}
        data-slices={report.slices}
        data-has-slices={hasSlices(report.renderer)}
        data-expected-milliseconds={report.expectedMilliseconds}
      >
        Believed error {percent(report.estimatedError)} ({parts.join(", ")}), by{" "}
        {RENDERER_NAMES[report.renderer] ?? Renderer[report.renderer]},{" "}
        {(Transport[report.transport] ?? "").toLowerCase()} transport
        {traced && ", traced light"}
        {hasSlices(report.renderer) && `, ${report.slices} slices`}
        {report.renderer === Renderer.METABALL && `, ${report.slices} balls`}
        {report.imageScale !== 1 && ` at ${percent(report.imageScale)} of the size`}
        {report.expectedMilliseconds !== undefined &&
          `; ${formatNumber(report.expectedMilliseconds)} ms a full frame`}
        .
      </p>
      {report.unmet !== "" && (
        <p class="unmet" role="status" data-testid="accuracy-unmet">
          {report.unmet}.
        </p>
      )}
    </>
  );
}

function hasSlices(renderer: Renderer): boolean {
  return renderer !== Renderer.METABALL && renderer !== Renderer.CUMULUS;
}

function percent(share: number): string {
  return `${formatNumber(100 * share)} %`;
}
