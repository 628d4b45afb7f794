// Controls that make a cloud without a model run.
import { CLOUD_LIMITS, type CloudDraft } from "../core/cloud";
import {
  GenerateCloudRequest_Interpolation as Interpolation,
  GenerateCloudRequest_Preset as Preset,
} from "../gen/thunderhead/v1/cloud_pb";
import { Choice, Section, Slider, Switch } from "./controls";
import type { Page } from "./page";

const PRESETS = [
  [Preset.FAIR_WEATHER_CUMULUS, "Fair-weather cumulus"],
  [Preset.CONGESTUS, "Congestus"],
  [Preset.CUMULUS_FIELD, "Field of cumuli"],
] as const;

const INTERPOLATIONS = [
  [Interpolation.LINEAR, "Linear"],
  [Interpolation.COSINE, "Cosine"],
  [Interpolation.CUBIC, "Cubic"],
] as const;

const NUMBERS = [
  ["octaves", "Octaves", CLOUD_LIMITS.octaves],
  ["persistence", "Persistence", CLOUD_LIMITS.persistence],
  ["featureSizeM", "Coarsest scale", CLOUD_LIMITS.featureSize],
  ["threshold", "Threshold t", CLOUD_LIMITS.threshold],
  ["dynamics", "Dynamics d", CLOUD_LIMITS.dynamics],
  ["waterKgPerM3", "Liquid water", CLOUD_LIMITS.water],
] as const;

export function CloudSection({ page }: { page: Page }) {
  const { state } = page;
  const cloud = state.cloud.value;
  const making = state.makingCloud.value;
  const change = (part: Partial<CloudDraft>) => {
    state.cloud.value = { ...cloud, ...part };
  };
  return (
    <Section title="Make a cloud" testId="cloud-section">
      <Choice
        label="Kind"
        testId="cloud-preset"
        value={cloud.preset}
        options={PRESETS}
        onChange={(preset) => change({ preset })}
      />
      <Slider
        label="Seed"
        limits={CLOUD_LIMITS.seed}
        value={cloud.seed}
        testId="cloud-seed"
        onChange={(seed) => change({ seed })}
      />
      <Switch
        label="Set noise and ellipsoids"
        checked={cloud.ownShape}
        testId="cloud-own-shape"
        onChange={(ownShape) => change({ ownShape })}
      />
      {cloud.ownShape && <OwnShape cloud={cloud} change={change} />}
      <div class="buttons">
        <button
          type="button"
          data-testid="make-cloud"
          disabled={making || state.connection.value.kind !== "live"}
          onClick={() => void page.makeCloud()}
        >
          {making ? "Making it…" : "Make and show"}
        </button>
        {making && (
          <button type="button" data-testid="stop-cloud" onClick={() => page.stopCloud()}>
            Stop
          </button>
        )}
      </div>
    </Section>
  );
}

interface OwnShapeProps {
  readonly cloud: CloudDraft;
  readonly change: (part: Partial<CloudDraft>) => void;
}

function OwnShape({ cloud, change }: OwnShapeProps) {
  return (
    <>
      {NUMBERS.map(([key, label, limits]) => (
        <Slider
          key={key}
          label={label}
          limits={limits}
          value={cloud[key]}
          testId={`cloud-${key}`}
          onChange={(value) => change({ [key]: value })}
        />
      ))}
      <Choice
        label="Interpolation"
        testId="cloud-interpolation"
        value={cloud.interpolation}
        options={INTERPOLATIONS}
        onChange={(interpolation) => change({ interpolation })}
      />
      <label class="lines">
        Ellipsoids instead of those of the kind, one per line: center x, y, z and radii x, y, z in
        m, then, if needed, rotation x, y, z in degrees
        <textarea
          rows={3}
          data-testid="cloud-ellipsoids"
          placeholder="0, 0, 1200, 600, 400, 300, 0, 0, 30"
          value={cloud.ellipsoids}
          onInput={(event) => change({ ellipsoids: event.currentTarget.value })}
        />
      </label>
    </>
  );
}
