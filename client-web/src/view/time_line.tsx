// The storm's times along the bottom: a tick for each time, play, step, loop and speed.

import { stretchesOf } from "../core/held_times";
import { momentOf } from "../core/moment";
import { PLAY_RATES } from "../core/playback";
import { formatElapsed } from "../core/units";
import type { StormTime } from "../gen/thunderhead/v1/storm_pb";
import { Icon } from "./icons";
import type { Page } from "./page";

// Maximum number of ticks with a time of day below them.
const MAX_LABELS = 6;

export function TimeLine({ page }: { page: Page }) {
  const { state, playback } = page;
  const storm = state.storm.value;
  const count = state.timeCount.value;
  if (storm === undefined || count === 0) return null;
  const index = Math.min(state.timeIndex.value, count - 1);
  const playing = playback.playing.value;
  const fixed = count < 2 || state.session.editBlock.value !== undefined;
  return (
    <section class="time-line" aria-label="Time line" data-testid="time-bar">
      <button
        type="button"
        class="round"
        data-testid="play"
        aria-label={playing ? "Pause" : "Play"}
        title={playing ? "Pause (space)" : "Play (space)"}
        disabled={fixed}
        onClick={() => playback.toggle()}
      >
        <Icon name={playing ? "pause" : "play"} />
      </button>
      <StepButton page={page} by={-1} fixed={fixed} />
      <Steps page={page} times={storm.times} index={index} fixed={fixed} />
      <StepButton page={page} by={1} fixed={fixed} />
      <Shown page={page} index={index} count={count} />
      <label class="rate">
        <span class="visually-hidden">Times per second</span>
        <select
          data-testid="rate"
          disabled={fixed}
          value={String(playback.timesPerSecond.value)}
          onChange={(event) => {
            playback.timesPerSecond.value = Number(event.currentTarget.value);
          }}
        >
          {PLAY_RATES.map((rate) => (
            <option
              key={rate}
              value={String(rate)}
              selected={rate === playback.timesPerSecond.value}
            >
              {rate} /s
            </option>
          ))}
        </select>
      </label>
      <button
        type="button"
        class="round"
        data-testid="loop"
        aria-pressed={playback.loops.value}
        aria-label="Loop"
        title="Repeat from the start"
        disabled={fixed}
        onClick={() => {
          playback.loops.value = !playback.loops.value;
        }}
      >
        <Icon name="loop" />
      </button>
    </section>
  );
}

interface StepButtonProps {
  readonly page: Page;
  readonly by: 1 | -1;
  readonly fixed: boolean;
}

function StepButton({ page: { playback }, by, fixed }: StepButtonProps) {
  const [name, label, key] =
    by < 0 ? (["back", "Time before", ","] as const) : (["forward", "Next time", "."] as const);
  return (
    <button
      type="button"
      class="round"
      data-testid={`step-${name}`}
      aria-label={label}
      title={`${label} (${key})`}
      disabled={fixed}
      onClick={() => playback.step(by)}
    >
      <Icon name={name} />
    </button>
  );
}

interface StepsProps {
  readonly page: Page;
  readonly times: readonly StormTime[];
  readonly index: number;
  readonly fixed: boolean;
}

// A slider with a tick for each time. The section around each time that is in the server's memory
// is shaded, because such a time appears at once.
function Steps({ page, times, index, fixed }: StepsProps) {
  const { state, playback } = page;
  const last = times.length - 1;
  const every = Math.ceil(times.length / MAX_LABELS);
  const spoken = state.moment.value;
  return (
    <div class="steps">
      <div class="ticks" aria-hidden="true">
        {stretchesOf(state.heldTimes.value, times.length).map(({ from, to }) => (
          <span
            key={from}
            class="held"
            data-testid="held"
            style={{ left: `${100 * from}%`, width: `${100 * (to - from)}%` }}
          />
        ))}
      </div>
      <div class="ticks" aria-hidden="true">
        {times.map((each, at) => (
          <span
            key={each.index}
            class="tick"
            style={{ left: `${last > 0 ? (100 * at) / last : 0}%` }}
          >
            {(at % every === 0 || at === last) && (at === last || last - at >= every) && (
              <span class="tick-label">{clockOf(each)}</span>
            )}
          </span>
        ))}
      </div>
      <input
        type="range"
        data-testid="time"
        aria-label="Valid time"
        aria-valuetext={`${spoken?.date ?? ""} ${spoken?.clock ?? ""} ${formatElapsed(state.leadS.value)}`}
        min={0}
        max={last}
        step={1}
        disabled={fixed}
        value={index}
        onInput={(event) => {
          playback.pause();
          page.showTime(event.currentTarget.valueAsNumber);
        }}
      />
    </div>
  );
}

function clockOf({ validTime, elapsedS }: StormTime): string {
  return momentOf(validTime, formatElapsed(elapsedS), undefined).clock;
}

function Shown({ page, index, count }: { page: Page; index: number; count: number }) {
  const { state } = page;
  const moment = state.moment.value;
  const time = state.shownTime.value;
  return (
    <output class="valid-time" data-testid="valid-time">
      <span class="clock">{moment?.clock}</span>
      <span class="quiet">
        {index + 1} of {count}
        {time?.deleted && " · deleted, shown from memory"}
      </span>
    </output>
  );
}
