// The controls of the metaball technique: the number of metaballs and how they scatter light (Man,
// Generating and Real-Time Rendering of Clouds).
import { transportOf } from "../core/rendering";
import { DEFAULTS, LIMITS } from "../core/scene";
import type { PageState } from "../core/state";
import { type Metaballs, Transport } from "../gen/thunderhead/v1/scene_pb";
import type { TechniqueDescription } from "../gen/thunderhead/v1/thunderhead_pb";
import { Slider, Switch } from "./controls";

interface MetaballProps {
  readonly state: PageState;
  readonly metaballs: Metaballs;
  readonly technique: TechniqueDescription | undefined;
}

export function MetaballControls({ state, metaballs, technique }: MetaballProps) {
  return (
    <>
      <Slider
        label="Metaballs"
        limits={LIMITS.metaballCount}
        value={metaballs.count ?? LIMITS.metaballCount.defaultValue}
        testId="metaball-count"
        afterRest
        onChange={(count) => state.editSettings({ count })}
      />
      <Switch
        label="Scatter isotropically"
        checked={metaballs.isotropic ?? DEFAULTS.metaballIsotropic}
        testId="metaball-isotropic"
        onChange={(isotropic) => state.editSettings({ isotropic })}
      />
      {transportOf(metaballs, technique) === Transport.PAPER && (
        <>
          <Slider
            label="Albedo a"
            limits={LIMITS.metaballAlbedo}
            value={metaballs.albedo ?? LIMITS.metaballAlbedo.defaultValue}
            testId="metaball-albedo"
            onChange={(albedo) => state.editSettings({ albedo })}
          />
          <Slider
            label="Optical depth τ"
            limits={LIMITS.metaballOpticalDepth}
            value={metaballs.opticalDepth ?? LIMITS.metaballOpticalDepth.defaultValue}
            testId="metaball-optical-depth"
            onChange={(opticalDepth) => state.editSettings({ opticalDepth })}
          />
        </>
      )}
    </>
  );
}
