// The tool that shows the valid time and its run, controls playback, and chooses the units of
// length.
import { momentOf } from "../../core/moment";
import { PLAY_RATES } from "../../core/playback";
import { formatElapsed, type LengthUnits, lengthUnits } from "../../core/units";
import { Choice, Switch } from "../controls";
import type { Page } from "../page";

const UNITS: readonly (readonly [LengthUnits, string])[] = [
  ["metric", "m and km"],
  ["aviation", "ft and nm"],
];

export function TimeTool({ page }: { page: Page }) {
  const { playback, state } = page;
  const { moment, run, leadS, zone } = state;
  const times = state.storm.value?.times ?? [];
  const index = Math.min(state.timeIndex.value, times.length - 1);
  return (
    <>
      <dl class="facts" data-testid="time-facts">
        <dt>Valid</dt>
        <dd>
          {moment.value?.date} {moment.value?.clock}
        </dd>
        {moment.value?.local !== undefined && (
          <>
            <dt>Local</dt>
            <dd>
              {moment.value.local} ({zone.value})
            </dd>
          </>
        )}
        <dt>Run</dt>
        <dd>{run.value === "" ? "not given in the file" : run.value}</dd>
        <dt>Lead time</dt>
        <dd>{formatElapsed(leadS.value)}</dd>
      </dl>
      <Choice
        label="Valid time"
        testId="time-choice"
        value={index}
        options={times.map((time, at) => {
          const { date, clock } = momentOf(time.validTime, formatElapsed(time.elapsedS), undefined);
          return [at, `${date} ${clock}`.trim()] as const;
        })}
        onChange={(at) => {
          playback.pause();
          page.showTime(at);
        }}
      />
      <Choice
        label="Times a second"
        testId="time-rate"
        value={playback.timesPerSecond.value}
        options={PLAY_RATES.map((rate) => [rate, `${rate}`] as const)}
        onChange={(rate) => {
          playback.timesPerSecond.value = rate;
        }}
      />
      <Switch
        label="Repeat from the start"
        testId="time-loop"
        checked={playback.loops.value}
        onChange={(loops) => {
          playback.loops.value = loops;
        }}
      />
      <Choice
        label="Lengths in"
        testId="units"
        value={lengthUnits.value}
        options={UNITS}
        onChange={(units) => {
          lengthUnits.value = units;
        }}
      />
    </>
  );
}
