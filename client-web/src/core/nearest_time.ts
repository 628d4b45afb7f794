// The time of a storm with the nearest date.
import { secondsBetween } from "./moment";

interface Dated {
  readonly validTime: string;
}

export interface NearestTime {
  readonly index: number;
  // Positive where it is later.
  readonly awayS: number;
}

// Runs farther apart have no times in common, such as an idealised one and a real one.
const FARTHEST_S = 2 * 86_400;

// Undefined where no date is near, or where dates cannot be compared.
export function nearestTime(validTime: string, times: readonly Dated[]): NearestTime | undefined {
  let nearest: NearestTime | undefined;
  times.forEach((time, index) => {
    const awayS = validTime === time.validTime ? 0 : secondsBetween(validTime, time.validTime);
    if (awayS === undefined || Math.abs(awayS) > FARTHEST_S) return;
    if (Math.abs(awayS) < Math.abs(nearest?.awayS ?? Infinity)) nearest = { index, awayS };
  });
  return nearest;
}

// The same number, as far as there are times.
export function sameNumber(index: number, times: readonly Dated[]): number {
  return Math.min(index, Math.max(0, times.length - 1));
}

// Of the nearest date, else of the same number.
export function timeLike(validTime: string, index: number, times: readonly Dated[]): number {
  return nearestTime(validTime, times)?.index ?? sameNumber(index, times);
}
