// Controls of the sun. It is set either by the clock, with a slider over the day, or by hand on the
// sky dome.
import { standingAzimuthDeg } from "../core/camera";
import { localClock } from "../core/moment";
import { LIMITS, withSky, withSun, withSunClock } from "../core/scene";
import type { PageState } from "../core/state";
import { dateTimeOfInput, gridAzimuthDeg, inputOfDateTime, trueAzimuthDeg } from "../core/sun";
import {
  atMinute,
  type ClockHere,
  clockOfMinute,
  DAY_MINUTES,
  dayInWords,
  firstDateTime,
  minuteOfDay,
  sunHeightsDeg,
} from "../core/sun_clock";
import { describeSun } from "../core/words";
import { Sun_Source, type SunClock } from "../gen/thunderhead/v1/scene_pb";
import { Segments, Slider, TimeInput, useTyped } from "./controls";
import { SunDome } from "./sun_dome";

const SOURCES = [
  [Sun_Source.BY_TIME, "By the clock", "Where the sun stands at that date, time and place."],
  [Sun_Source.BY_HAND, "By hand", "Where you put it."],
] as const;

export function SunControls({ state }: { state: PageState }) {
  const sun = state.sun.value;
  const byTime = sun?.source === Sun_Source.BY_TIME;
  const direction = state.sunDirection.value;
  const trueNorthDeg = state.trueNorthDeg.value;
  // Moving the sun by hand stops the clock. An angle that the change does not set stays the same.
  const point = (change: { azimuthDeg?: number; elevationDeg?: number }) =>
    state.edit((scene) => withSun(scene, { ...direction, ...change, source: Sun_Source.BY_HAND }));
  const here = state.clockHere.value;
  return (
    <>
      <Segments
        label="The sun's direction"
        testId="sun-source"
        value={byTime ? Sun_Source.BY_TIME : Sun_Source.BY_HAND}
        options={SOURCES}
        otherwise=""
        onChange={(source) => state.edit((scene) => withSun(scene, { ...direction, source }))}
      />
      {here !== undefined && <DaySlider state={state} here={here} byTime={byTime} />}
      {byTime && <ClockControls state={state} clock={sun?.clock} />}
      <SunDome
        sun={direction}
        trueNorthDeg={trueNorthDeg}
        disabled={state.session.editBlock.value !== undefined}
        cameraAzimuthDeg={standingAzimuthDeg(state.pose.value)}
        onChange={point}
      />
      <p class="quiet" data-testid="sun-in-words">
        {describeSun(direction, trueNorthDeg)}
      </p>
      {!byTime && (
        <>
          <Slider
            label="Azimuth"
            limits={LIMITS.sunAzimuth}
            value={trueAzimuthDeg(direction.azimuthDeg, trueNorthDeg)}
            testId="sun-azimuth"
            onChange={(deg) => point({ azimuthDeg: gridAzimuthDeg(deg, trueNorthDeg) })}
          />
          <Slider
            label="Elevation"
            limits={LIMITS.sunElevation}
            value={direction.elevationDeg}
            testId="sun-elevation"
            onChange={(elevationDeg) => point({ elevationDeg })}
          />
        </>
      )}
      <Slider
        label="Haze (turbidity)"
        limits={LIMITS.turbidity}
        value={state.sky.value?.turbidity ?? LIMITS.turbidity.defaultValue}
        testId="turbidity"
        onChange={(turbidity) => state.edit((scene) => withSky(scene, { turbidity }))}
      />
    </>
  );
}

interface DayProps {
  readonly state: PageState;
  readonly here: ClockHere;
  readonly byTime: boolean;
}

// A slider over the local time of day, with sunrise and sunset. Moving it starts the clock.
function DaySlider({ state, here, byTime }: DayProps) {
  const zone = state.sunZone.value;
  const minute = minuteOfDay(here.instant, zone);
  const elapsedS = state.shownTime.value?.elapsedS ?? 0;
  const set = (next: number) => {
    const dateTime = firstDateTime(atMinute(here.instant, next, zone), elapsedS);
    state.edit((scene) =>
      withSun(withSunClock(scene, { dateTime }), { source: Sun_Source.BY_TIME }),
    );
  };
  const clock = useTyped(clockOfMinute(minute), ({ value }) => {
    const [hours, minutes] = value.split(":").map(Number);
    if (hours === undefined || minutes === undefined) return false;
    set(60 * hours + minutes);
    return true;
  });
  const sky = `linear-gradient(90deg, ${sunHeightsDeg(here, zone, SKY_STEPS).map(skyColor).join(", ")})`;
  return (
    <div class={byTime ? "day" : "day off"}>
      <label for="day-time">
        Local time <strong>{localClock(here.instant, zone)}</strong>
      </label>
      <input type="time" aria-label={`Local time, ${zone}`} data-testid="day-clock" {...clock} />
      <input
        id="day-time"
        type="range"
        class="day-slider"
        data-testid="day-time"
        min={0}
        max={DAY_MINUTES - 1}
        step={5}
        value={minute}
        aria-valuetext={localClock(here.instant, zone)}
        style={{ background: sky }}
        onInput={(event) => set(event.currentTarget.valueAsNumber)}
      />
      <span class="quiet" data-testid="sun-rise-set">
        {dayInWords(here, zone)}
      </span>
    </div>
  );
}

// Number of intervals at which the sky's colour is computed over a day: one per half hour.
const SKY_STEPS = 48;
// Pairs of the sun's elevation in degrees and the sky's colour (red, green, blue). Colours in
// between are interpolated.
const SKY = [
  [-8, [8, 14, 30]],
  [-1, [217, 146, 91]],
  [10, [112, 164, 220]],
] as const;

function skyColor(heightDeg: number): string {
  const [lowest, , highest] = SKY;
  if (heightDeg <= lowest[0]) return `rgb(${lowest[1].join(" ")})`;
  if (heightDeg >= highest[0]) return `rgb(${highest[1].join(" ")})`;
  const [below, above] = heightDeg < SKY[1][0] ? [SKY[0], SKY[1]] : [SKY[1], SKY[2]];
  const share = (heightDeg - below[0]) / (above[0] - below[0]);
  const mixed = ([0, 1, 2] as const).map((i) => (1 - share) * below[1][i] + share * above[1][i]);
  return `rgb(${mixed.map(Math.round).join(" ")})`;
}

function ClockControls({ state, clock }: { state: PageState; clock: SunClock | undefined }) {
  const set = (change: Partial<Pick<SunClock, "dateTime" | "latitudeDeg" | "longitudeDeg">>) =>
    state.edit((scene) => withSunClock(scene, change));
  const initial = state.storm.value?.sunClock;
  return (
    <details class="folded">
      <summary>Date and place</summary>
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
    </details>
  );
}
