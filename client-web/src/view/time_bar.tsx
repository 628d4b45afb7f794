// The storm's times: a slider with the valid time, and play.
import { PLAY_RATES } from "../core/playback";
import { formatElapsed, formatValidTime } from "../core/units";
import type { Page } from "./page";

export function TimeBar({ page }: { page: Page }) {
  const { state, playback } = page;
  const storm = state.storm.value;
  const count = state.timeCount.value;
  if (storm === undefined || count === 0) return null;
  const index = Math.min(state.timeIndex.value, count - 1);
  const time = storm.times[index];
  const label = time === undefined ? "" : formatValidTime(time.validTime, time.elapsedS);
  const playing = playback.playing.value;
  const blocked = state.session.editBlock.value !== undefined;
  const fixed = count < 2 || blocked;
  return (
    <section class="time-bar" aria-label="Time" data-testid="time-bar">
      <button
        type="button"
        class="round"
        data-testid="play"
        aria-label={playing ? "Pause" : "Play"}
        title={playing ? "Pause (space)" : "Play (space)"}
        disabled={fixed}
        onClick={() => playback.toggle()}
      >
        <svg viewBox="0 0 16 16" aria-hidden="true">
          <path d={playing ? "M4 3h3v10H4zM9 3h3v10H9z" : "M4 2.5l9 5.5-9 5.5z"} />
        </svg>
      </button>
      <input
        type="range"
        data-testid="time"
        aria-label="Valid time"
        aria-valuetext={label}
        min={0}
        max={count - 1}
        step={1}
        disabled={fixed}
        value={index}
        onInput={(event) => {
          playback.pause();
          page.showTime(event.currentTarget.valueAsNumber);
        }}
      />
      <output class="valid-time" data-testid="valid-time">
        <span>{label}</span>
        <span class="quiet">
          {time !== undefined && formatElapsed(time.elapsedS)} · {index + 1} of {count}
          {time?.deleted && " · deleted, shown from memory"}
        </span>
      </output>
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
              {rate}/s
            </option>
          ))}
        </select>
      </label>
    </section>
  );
}
