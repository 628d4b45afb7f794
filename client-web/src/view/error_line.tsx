// The estimated error of the picture on the screen, in a line over it.
import { nameOfPreset } from "../core/names";
import { errorSource } from "../core/picture_error";
import type { PageState } from "../core/state";
import { formatNumber } from "../core/units";
import type { AccuracyReport, Refinement } from "../gen/thunderhead/v1/frame_pb";

// Relative error (0.5 is 50 %) at which the error bar is full.
const LARGE_ERROR = 0.5;

export function ErrorLine({ state }: { state: PageState }) {
  const frame = state.frame.value;
  if (frame === undefined) return null;
  const { accuracy, refinement, refined } = frame;
  const preset = state.preset.value;
  return (
    <p class="error-line" data-testid="error-line">
      {refinement !== undefined && <RefinementBrief refinement={refinement} />}
      {refinement === undefined && accuracy !== undefined && (
        <>
          <span>
            This picture is <strong>{formatNumber(100 * accuracy.estimatedError)} %</strong> off
          </span>
          <span
            class="quiet"
            data-testid="error-source"
            data-measured={accuracy.measured}
            data-error-low={accuracy.errorLow}
            data-error-high={accuracy.errorHigh}
            title={sourceTitle(accuracy)}
          >
            {errorSource(accuracy)}
          </span>
          <meter
            aria-hidden="true"
            min={0}
            max={LARGE_ERROR}
            value={Math.min(LARGE_ERROR, accuracy.estimatedError)}
          />
        </>
      )}
      <span class={refined ? "quiet" : "coarse"}>
        {refined
          ? preset === undefined
            ? "as set"
            : nameOfPreset(preset).toLowerCase()
          : "coarse"}
      </span>
    </p>
  );
}

function sourceTitle(accuracy: AccuracyReport): string {
  return accuracy.measured
    ? "Measured on this picture by tracing light through it; the true error is in this range in 95 of 100 cases"
    : "The error that the same settings had on other storms; this picture's own error is measured while the view rests";
}

// The progress of the reference (the path tracer that refines its picture continually). It is
// always visible, because the picture's noise cannot be judged without it.
function RefinementBrief({ refinement }: { refinement: Refinement }) {
  const { samplesPerPixel, relativeError } = refinement;
  return (
    <span
      data-testid="refinement"
      data-samples-per-pixel={samplesPerPixel}
      data-relative-error={relativeError}
      title="Samples per pixel, and a pixel's standard error divided by the mean radiance"
    >
      {samplesPerPixel} samples a pixel
      {relativeError !== undefined && ` ± ${formatNumber(100 * relativeError)} %`}
    </span>
  );
}
