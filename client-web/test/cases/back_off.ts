import { BackOff } from "../../src/core/back_off";
import type { Runner } from "./case_files";

export const runBackOff: Runner = () => {
  let random = 0;
  const backOff = new BackOff(() => random);
  return {
    next: (step) => {
      random = step.number("random");
      const delayMs = backOff.next(step.number("least_ms", 0));
      return { delay_ms: delayMs, attempts: backOff.attempts };
    },
    reset: () => {
      backOff.reset();
      return { attempts: backOff.attempts };
    },
  };
};
