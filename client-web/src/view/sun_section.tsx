// The sun: set by hand, or where it stands at a date, time and place.
import { standingAzimuthDeg } from "../core/camera";
import { LIMITS, withSun, withSunClock } from "../core/scene";
import type { PageState } from "../core/state";
import { dateTimeOfInput, inputOfDateTime } from "../core/sun";
import { Sun_Source, type SunClock } from "../gen/thunderhead/v1/scene_pb";
import { Choice, Section, Slider, TimeInput } from "./controls";
import { SunDome } from "./sun_dome";

const SOURCES = [
  [Sun_Source.BY_HAND, "By hand"],
  [Sun_Source.BY_TIME, "By date, time and place"],
] as const;

export function SunSection({ state }: { state: PageState }) {
  const sun = state.sun.value;
  const byTime = sun?.source === Sun_Source.BY_TIME;
  const direction = state.sunDirection.value;
  // Moving the sun by hand stops the clock; the other angle stays.
  const point = (change: { azimuthDeg?: number; elevationDeg?: number }) =>
    state.edit((scene) => withSun(scene, { ...direction, ...change, source: Sun_Source.BY_HAND }));
  return (
    <Section title="Sun" open testId="sun-section">
      <Choice
        label="Direction"
        testId="sun-source"
        value={byTime ? Sun_Source.BY_TIME : Sun_Source.BY_HAND}
        options={SOURCES}
        onChange={(source) => state.edit((scene) => withSun(scene, { ...direction, source }))}
      />
      <SunDome
        sun={direction}
        disabled={state.session.editBlock.value !== undefined}
        cameraAzimuthDeg={standingAzimuthDeg(state.pose.value)}
        onChange={point}
      />
      {byTime && <ClockControls state={state} clock={sun?.clock} />}
      <Slider
        label="Azimuth"
        limits={LIMITS.sunAzimuth}
        value={direction.azimuthDeg}
        testId="sun-azimuth"
        onChange={(azimuthDeg) => point({ azimuthDeg })}
      />
      <Slider
        label="Elevation"
        limits={LIMITS.sunElevation}
        value={direction.elevationDeg}
        testId="sun-elevation"
        onChange={(elevationDeg) => point({ elevationDeg })}
      />
      <Slider
        label="Irradiance"
        limits={LIMITS.sunIrradiance}
        value={sun?.irradiance ?? LIMITS.sunIrradiance.defaultValue}
        testId="sun-irradiance"
        onChange={(irradiance) => state.edit((scene) => withSun(scene, { irradiance }))}
      />
    </Section>
  );
}

function ClockControls({ state, clock }: { state: PageState; clock: SunClock | undefined }) {
  const set = (change: Partial<Pick<SunClock, "dateTime" | "latitudeDeg" | "longitudeDeg">>) =>
    state.edit((scene) => withSunClock(scene, change));
  const initial = state.storm.value?.sunClock;
  return (
    <>
      <TimeInput
        label="First time, UTC"
        testId="sun-date-time"
        value={inputOfDateTime(clock?.dateTime || initial?.dateTime || "")}
        onChange={(value) => set({ dateTime: dateTimeOfInput(value) })}
      />
      <Slider
        label="Latitude"
        limits={LIMITS.sunLatitude}
        value={clock?.latitudeDeg ?? initial?.latitudeDeg}
        initial={initial?.latitudeDeg}
        testId="sun-latitude"
        onChange={(latitudeDeg) => set({ latitudeDeg })}
      />
      <Slider
        label="Longitude"
        limits={LIMITS.sunLongitude}
        value={clock?.longitudeDeg ?? initial?.longitudeDeg}
        initial={initial?.longitudeDeg}
        testId="sun-longitude"
        onChange={(longitudeDeg) => set({ longitudeDeg })}
      />
    </>
  );
}
