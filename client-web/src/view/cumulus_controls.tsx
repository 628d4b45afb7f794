// The controls of the cumulus technique: the cloud's surface and its shading (Neyret 2000).
import { DEFAULTS, LIMITS } from "../core/scene";
import type { PageState } from "../core/state";
import {
  Cumulus_Component as Component,
  type Cumulus,
  Cumulus_Source as Source,
} from "../gen/thunderhead/v1/scene_pb";
import { Choice, Slider } from "./controls";

const SOURCES = [
  [Source.STORM, "The storm's cloud and ice"],
  [Source.CAULIFLOWER, "Cauliflower"],
  [Source.FAIR_WEATHER_CUMULUS, "Fair-weather cumulus"],
  [Source.CONGESTUS, "Congestus"],
  [Source.CUMULUS_FIELD, "Field of cumulus"],
  [Source.ELLIPSOID, "One ellipsoid"],
] as const;

const COMPONENTS = [
  [Component.ALL, "All"],
  [Component.DIRECT, "Direct sunlight"],
  [Component.INTER_REFLECTION, "Inter-reflection"],
  [Component.AMBIENT, "Sky and ground"],
  [Component.CORONA, "Corona"],
  [Component.BALLS, "Bare ellipsoids"],
] as const;

interface CumulusProps {
  readonly state: PageState;
  readonly cumulus: Cumulus;
}

export function CumulusControls({ state, cumulus }: CumulusProps) {
  const source = cumulus.source || DEFAULTS.cumulusSource;
  return (
    <>
      <Choice
        label="Surface"
        testId="cumulus-source"
        value={source}
        options={SOURCES}
        onChange={(next) => state.editSettings({ source: next })}
      />
      <Choice
        label="Light shown"
        testId="cumulus-component"
        value={cumulus.component || DEFAULTS.cumulusComponent}
        options={COMPONENTS}
        onChange={(component) => state.editSettings({ component })}
      />
      <Slider
        label="Seed"
        limits={LIMITS.cumulusSeed}
        value={cumulus.seed ?? LIMITS.cumulusSeed.defaultValue}
        testId="cumulus-seed"
        onChange={(seed) => state.editSettings({ seed })}
      />
      <Slider
        label="Scales"
        limits={LIMITS.cumulusScales}
        value={cumulus.scales ?? LIMITS.cumulusScales.defaultValue}
        testId="cumulus-scales"
        onChange={(scales) => state.editSettings({ scales })}
      />
      {source === Source.STORM && (
        <Slider
          label="Least extinction"
          limits={LIMITS.cumulusLeastExtinction}
          value={cumulus.leastExtinctionPerM ?? LIMITS.cumulusLeastExtinction.defaultValue}
          testId="cumulus-least-extinction"
          onChange={(leastExtinctionPerM) => state.editSettings({ leastExtinctionPerM })}
        />
      )}
      <Slider
        label="Corona"
        limits={LIMITS.cumulusCorona}
        value={cumulus.corona ?? LIMITS.cumulusCorona.defaultValue}
        testId="cumulus-corona"
        onChange={(corona) => state.editSettings({ corona })}
      />
      <Slider
        label="Light traps"
        limits={LIMITS.cumulusTrap}
        value={cumulus.trap ?? LIMITS.cumulusTrap.defaultValue}
        testId="cumulus-trap"
        onChange={(trap) => state.editSettings({ trap })}
      />
      <Slider
        label="Transmission"
        limits={LIMITS.cumulusTransmission}
        value={cumulus.transmission ?? LIMITS.cumulusTransmission.defaultValue}
        testId="cumulus-transmission"
        onChange={(transmission) => state.editSettings({ transmission })}
      />
      <Slider
        label="Roughness"
        limits={LIMITS.cumulusRoughness}
        value={cumulus.roughness ?? LIMITS.cumulusRoughness.defaultValue}
        testId="cumulus-roughness"
        onChange={(roughness) => state.editSettings({ roughness })}
      />
    </>
  );
}
