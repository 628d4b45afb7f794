// When: the valid time, the run, and how the times are played.
import { PLAY_RATES } from "../../core/playback";
import { Choice } from "../controls";
import type { Page } from "../page";

export function TimeTool({ page }: { page: Page }) {
  const { playback } = page;
  return (
    <Choice
      label="Times a second"
      testId="time-rate"
      value={playback.timesPerSecond.value}
      options={PLAY_RATES.map((rate) => [rate, `${rate}`] as const)}
      onChange={(rate) => {
        playback.timesPerSecond.value = rate;
      }}
    />
  );
}
