import { PLAY_RATES, Playback } from "../../src/core/playback";
import type { Runner } from "./case_files";

export const runPlayback: Runner = (given) => {
  let count = given.number("count");
  let index = given.number("index");
  let shown = false;
  let paint: ((nowMs: number) => void) | undefined;
  const playback = new Playback({
    timeCount: () => count,
    timeIndex: () => index,
    isShown: () => shown,
    showTime: (time) => {
      index = time;
    },
    onNextPaint: (callback) => {
      paint = callback;
      return () => {
        paint = undefined;
      };
    },
  });
  playback.timesPerSecond.value = given.number("times_per_second", playback.timesPerSecond.value);
  playback.loops.value = given.flag("loops", playback.loops.value);
  const observed = () => ({ index, playing: playback.playing.value });
  return {
    toggle: () => {
      playback.toggle();
      return observed();
    },
    step: (step) => {
      playback.step(step.number("by"));
      return observed();
    },
    count: (step) => {
      count = step.number("count");
      return observed();
    },
    tick: (step) => {
      shown = step.flag("shown");
      const nowMs = step.number("at_ms");
      const due = paint;
      paint = undefined;
      due?.(nowMs);
      return observed();
    },
    rates: () => ({ rates: [...PLAY_RATES] }),
  };
};
