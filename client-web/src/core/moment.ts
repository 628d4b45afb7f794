// A valid time as texts for people: the day, the time of day in UTC, and the local time if the
// storm has geographical coordinates.

import { formatElapsed } from "./units";

export interface Moment {
  // A date like "2013-05-20", or "day 1" for an idealised run, which starts in year 1. The text is
  // empty if only the elapsed time is known.
  readonly date: string;
  // A time like "20:00Z".
  readonly clock: string;
  // A time like "15:00 CDT"; undefined if the storm has no geographical coordinates or no date.
  readonly local: string | undefined;
}

const VALID_TIME = /^(\d{4,})-(\d\d)-(\d\d)[T_ ](\d\d):(\d\d)(?::(\d\d))?/;

// Returns the instant of a valid time; undefined if the time cannot be parsed, and for idealised
// runs, whose years (below 100) have no meaning.
export function instantOf(validTime: string): Date | undefined {
  const match = VALID_TIME.exec(validTime);
  if (match === null || Number(match[1]) < 100) return undefined;
  const [, year, month, day, hour, minute, second] = match.map(Number);
  return new Date(
    Date.UTC(year ?? 0, (month ?? 1) - 1, day ?? 1, hour ?? 0, minute ?? 0, second || 0),
  );
}

// Returns the seconds between two valid times, of idealised runs too; undefined if one of the times
// cannot be parsed.
export function secondsBetween(from: string, to: string): number | undefined {
  const [start, end] = [from, to].map((each) => {
    const match = VALID_TIME.exec(each);
    const [year, month, day, hour, minute, second] = (match ?? [])
      .slice(1)
      .map((part) => Number(part ?? 0));
    // Date.UTC would interpret years below 100 as years after 1900.
    return match === null
      ? undefined
      : Date.UTC((year ?? 0) + 2000, (month ?? 1) - 1, day, hour, minute, second);
  });
  return start === undefined || end === undefined ? undefined : (end - start) / 1000;
}

export function momentOf(validTime: string, elapsedText: string, zone: string | undefined): Moment {
  const match = VALID_TIME.exec(validTime);
  if (match === null) return { date: "", clock: validTime || elapsedText, local: undefined };
  const [, year, month, day, hour, minute, second] = match;
  const seconds = second !== undefined && second !== "00" ? `:${second}` : "";
  const date = Number(year) < 100 ? `day ${Number(day)}` : `${year}-${month}-${day}`;
  const instant = instantOf(validTime);
  return {
    date,
    clock: `${hour}:${minute}${seconds}Z`,
    local: instant === undefined ? undefined : localClock(instant, zone),
  };
}

// Returns a time like "15:00 CDT" in a time zone of the IANA database.
export function localClock(instant: Date, zone: string | undefined): string | undefined {
  if (zone === undefined) return undefined;
  // The locale is en-US because it has the abbreviations of American zones, such as CDT.
  return new Intl.DateTimeFormat("en-US", {
    hour: "2-digit",
    minute: "2-digit",
    hourCycle: "h23",
    timeZone: zone,
    timeZoneName: "short",
  }).format(instant);
}

// Returns the nautical time zone of a longitude, without daylight-saving time. The page uses this
// zone until the real zone of the place is known.
export function zoneOfLongitude(longitudeDeg: number): string {
  const hours = Math.round(longitudeDeg / 15);
  if (hours === 0) return "Etc/GMT";
  // In the database's names Etc/GMT±N, positive numbers are west of Greenwich.
  return `Etc/GMT${hours > 0 ? "-" : "+"}${Math.abs(hours)}`;
}

// Returns the minutes by which a zone is ahead of UTC at an instant.
export function minutesAhead(instant: Date, zone: string): number {
  const parts = new Intl.DateTimeFormat("en-GB", {
    year: "numeric",
    month: "numeric",
    day: "numeric",
    hour: "numeric",
    minute: "numeric",
    hourCycle: "h23",
    timeZone: zone,
  }).formatToParts(instant);
  const part = (type: string) => Number(parts.find((each) => each.type === type)?.value);
  const local = Date.UTC(
    part("year"),
    part("month") - 1,
    part("day"),
    part("hour"),
    part("minute"),
  );
  return Math.round((local - instant.getTime()) / 60_000);
}

// Returns a text like "2000-05-20 21:40Z", or the elapsed time if the file has no valid time.
export function timeInWords(
  time: { readonly validTime: string; readonly elapsedS: number } | undefined,
): string {
  if (time === undefined) return "";
  const { date, clock } = momentOf(time.validTime, formatElapsed(time.elapsedS), undefined);
  return `${date} ${clock}`.trim();
}
