// The sun's clock (the date and time that determine the sun's direction) at the storm time that is
// shown. A scene stores the clock's setting for the storm's first time, and the clock advances with
// the storm's time. People instead set the clock for the picture that they see, in local time.
import { getPosition, getTimes } from "suncalc";
import type { SunClock } from "../gen/thunderhead/v1/scene_pb";
import { minutesAhead } from "./moment";

const MINUTE_MS = 60_000;
export const DAY_MINUTES = 1440;

export interface ClockHere {
  readonly instant: Date;
  readonly latitudeDeg: number;
  readonly longitudeDeg: number;
}

// Returns the clock of the picture: the scene's clock, in which values that are not set are taken
// from the storm's clock. Returns undefined while the date or the place is unknown.
export function clockHere(
  set: SunClock | undefined,
  storm: SunClock | undefined,
  elapsedS: number,
): ClockHere | undefined {
  const first = Date.parse(set?.dateTime || storm?.dateTime || "");
  const latitudeDeg = set?.latitudeDeg ?? storm?.latitudeDeg;
  const longitudeDeg = set?.longitudeDeg ?? storm?.longitudeDeg;
  if (Number.isNaN(first) || latitudeDeg === undefined || longitudeDeg === undefined)
    return undefined;
  return { instant: new Date(first + 1000 * elapsedS), latitudeDeg, longitudeDeg };
}

// Returns the setting of the clock at the storm's first time that makes the clock show `instant`
// after `elapsedS` seconds.
export function firstDateTime(instant: Date, elapsedS: number): string {
  return new Date(instant.getTime() - 1000 * elapsedS).toISOString().replace(/\.\d+Z$/, "Z");
}

// Returns minutes since midnight, local time.
export function minuteOfDay(instant: Date, zone: string): number {
  const minutes = Math.floor(instant.getTime() / MINUTE_MS) + minutesAhead(instant, zone);
  return ((minutes % DAY_MINUTES) + DAY_MINUTES) % DAY_MINUTES;
}

// Returns the instant of the same local day at another minute.
export function atMinute(instant: Date, minute: number, zone: string): Date {
  return new Date(instant.getTime() + (minute - minuteOfDay(instant, zone)) * MINUTE_MS);
}

// Returns the minutes of the local day at which the sun rises and sets; undefined if the sun does
// not rise or set on this day.
export function sunriseAndSunset(
  { instant, latitudeDeg, longitudeDeg }: ClockHere,
  zone: string,
): { readonly sunrise: number | undefined; readonly sunset: number | undefined } {
  // Noon is used because it belongs to the same solar day in every time zone.
  const noon = atMinute(instant, DAY_MINUTES / 2, zone);
  const { sunrise, sunset } = getTimes(noon, latitudeDeg, longitudeDeg);
  return {
    sunrise: sunrise === null ? undefined : minuteOfDay(sunrise, zone),
    sunset: sunset === null ? undefined : minuteOfDay(sunset, zone),
  };
}

// Returns sunrise and sunset of the local day, like "Sunrise 06:12 · sunset 20:29".
export function dayInWords(here: ClockHere, zone: string): string {
  const { sunrise, sunset } = sunriseAndSunset(here, zone);
  if (sunrise !== undefined && sunset !== undefined)
    return `Sunrise ${clockOfMinute(sunrise)} · sunset ${clockOfMinute(sunset)}`;
  if (sunrise !== undefined) return `Sunrise ${clockOfMinute(sunrise)}; the sun does not set`;
  if (sunset !== undefined) return `Sunset ${clockOfMinute(sunset)}; the sun did not rise`;
  const [, noonDeg = 0] = sunHeightsDeg(here, zone, 2);
  return noonDeg > 0 ? "The sun does not set" : "The sun does not rise";
}

// Returns the sun's elevation at evenly spaced times over the local day, from its first midnight to
// its last.
export function sunHeightsDeg(here: ClockHere, zone: string, steps: number): number[] {
  return Array.from({ length: steps + 1 }, (_, at) => {
    const then = atMinute(here.instant, (at * DAY_MINUTES) / steps, zone);
    return getPosition(then, here.latitudeDeg, here.longitudeDeg).altitude;
  });
}

// Returns a text like "18:30".
export function clockOfMinute(minute: number): string {
  const whole = Math.round(minute) % DAY_MINUTES;
  return `${String(Math.floor(whole / 60)).padStart(2, "0")}:${String(whole % 60).padStart(2, "0")}`;
}
