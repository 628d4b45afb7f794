// Finds the time of a storm whose date is nearest to a given valid time.
import { secondsBetween } from "./moment";

interface Dated {
  readonly validTime: string;
}

export interface NearestTime {
  readonly index: number;
  // Seconds from the given time to the found time; positive if the found time is later.
  readonly awayS: number;
}

// Maximum difference in seconds at which a date counts as near. Runs that are farther apart, such
// as an idealised and a real run, have no times in common.
const FARTHEST_S = 2 * 86_400;

// Returns the nearest time; undefined if no date is near or the dates cannot be compared.
export function nearestTime(validTime: string, times: readonly Dated[]): NearestTime | undefined {
  let nearest: NearestTime | undefined;
  times.forEach((time, index) => {
    const awayS = validTime === time.validTime ? 0 : secondsBetween(validTime, time.validTime);
    if (awayS === undefined || Math.abs(awayS) > FARTHEST_S) return;
    if (Math.abs(awayS) < Math.abs(nearest?.awayS ?? Infinity)) nearest = { index, awayS };
  });
  return nearest;
}

// Returns `index`, limited to the indices of `times`.
export function sameNumber(index: number, times: readonly Dated[]): number {
  return Math.min(index, Math.max(0, times.length - 1));
}

// Returns the index of the time with the nearest date. If no date is near, returns `index`, limited
// to the indices of `times`.
export function timeLike(validTime: string, index: number, times: readonly Dated[]): number {
  return nearestTime(validTime, times)?.index ?? sameNumber(index, times);
}
