// Formats numbers and units for people.
import { signal } from "@preact/signals-core";
import type { Limits } from "./limits";

// Units of length: metres and kilometres, or feet and nautical miles as pilots use them.
export type LengthUnits = "metric" | "aviation";
export const lengthUnits = signal<LengthUnits>("metric");

const FOOT_M = 0.3048;
const NAUTICAL_MILE_M = 1852;

// Whether a length is a distance or a height, because pilots use different units for them.
export type LengthKind = "distance" | "height";

interface LengthUnit {
  readonly metres: number;
  readonly symbol: string;
}

function unitOfLength(lengthM: number, kind: LengthKind): LengthUnit {
  if (lengthUnits.value === "aviation")
    return kind === "height" || Math.abs(lengthM) < NAUTICAL_MILE_M / 4
      ? { metres: FOOT_M, symbol: "ft" }
      : { metres: NAUTICAL_MILE_M, symbol: "nm" };
  return Math.abs(lengthM) < 1000 ? { metres: 1, symbol: "m" } : { metres: 1000, symbol: "km" };
}

// Returns a text like "8.4 km" or "27600 ft".
export function formatLength(lengthM: number, kind: LengthKind): string {
  const { metres, symbol } = unitOfLength(lengthM, kind);
  return `${formatNumber(lengthM / metres)} ${symbol}`;
}

// Returns the largest length that is at most `lengthM` and is 1, 2 or 5 times a power of ten in its
// display unit.
export function roundLength(lengthM: number): number {
  const { metres } = unitOfLength(lengthM, "distance");
  const value = lengthM / metres;
  const power = 10 ** Math.floor(Math.log10(value));
  const digit = [5, 2, 1].find((each) => each * power <= value) ?? 1;
  return digit * power * metres;
}

export interface DisplayUnit {
  // Factor by which a value in the schema's unit is multiplied.
  readonly factor: number;
  // The unit's symbol, printed after the number; empty for a pure number.
  readonly symbol: string;
}

const SYMBOLS: Readonly<Record<string, string>> = { "1": "", deg: "°", "kg/m3": "kg/m³", m: "m" };

// Returns the unit in which a number is shown. A length whose maximum is at most 1 m is shown in
// millimetres. A length whose maximum is at least 100 km is shown in kilometres or nautical miles,
// and any other length in metres or feet.
export function displayUnitOf(limits: Limits): DisplayUnit {
  if (limits.unit === "m" && limits.maximum <= 1) return { factor: 1e3, symbol: "mm" };
  if (limits.unit === "m" && limits.maximum > 1 && lengthUnits.value === "aviation")
    return limits.maximum >= 1e5
      ? { factor: 1 / NAUTICAL_MILE_M, symbol: "nm" }
      : { factor: 1 / FOOT_M, symbol: "ft" };
  if (limits.unit === "m" && limits.maximum >= 1e5) return { factor: 1e-3, symbol: "km" };
  return { factor: 1, symbol: SYMBOLS[limits.unit] ?? limits.unit };
}

// Formats a number with three significant digits, without trailing zeros. Numbers from 100 to a
// million are rounded to integers. Numbers from a million or below 0.0001 have an exponent.
export function formatNumber(value: number): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const magnitude = Math.abs(value);
  if (magnitude >= 1e6 || magnitude < 1e-4) return value.toExponential(2).replace("e+", "e");
  if (magnitude >= 100) return String(Math.round(value));
  return String(Number(value.toPrecision(3)));
}

export function formatQuantity(value: number, limits: Limits): string {
  const unit = displayUnitOf(limits);
  const separator = unit.symbol === "" || unit.symbol === "°" ? "" : " ";
  return `${formatNumber(value * unit.factor)}${separator}${unit.symbol}`;
}

export function formatBytes(bytes: number): string {
  const steps = ["B", "kB", "MB", "GB"];
  let value = bytes;
  let step = 0;
  while (value >= 999.5 && step < steps.length - 1) {
    value /= 1000;
    step += 1;
  }
  return `${formatNumber(value)} ${steps[step]}`;
}

// Returns a text like "1.4 Mbit/s".
export function formatBitRate(bytesPerSecond: number): string {
  const kbit = (bytesPerSecond * 8) / 1000;
  return kbit >= 999.5 ? `${formatNumber(kbit / 1000)} Mbit/s` : `${Math.round(kbit)} kbit/s`;
}

// Returns a text like "2013-05-20 20:00 UTC". For idealised runs, which start in year 1,
// "0001-01-01T00:20:00Z" becomes "day 1, 00:20". Without a valid time, returns the elapsed time.
export function formatValidTime(validTime: string, elapsedS: number): string {
  const match = /^(\d{4,})-(\d\d)-(\d\d)[T_ ](\d\d):(\d\d)(?::(\d\d))?/.exec(validTime);
  if (!match) return validTime === "" ? formatElapsed(elapsedS) : validTime;
  const [, year, month, day, hour, minute, second] = match;
  const seconds = second !== undefined && second !== "00" ? `:${second}` : "";
  if (Number(year) < 100) return `day ${Number(day)}, ${hour}:${minute}${seconds}`;
  return `${year}-${month}-${day} ${hour}:${minute}${seconds} UTC`;
}

// Returns a time since the storm's first time as a text like "+1 h 20 min".
export function formatElapsed(elapsedS: number): string {
  const minutes = Math.floor(elapsedS / 60);
  const hours = Math.floor(minutes / 60);
  const seconds = Math.round(elapsedS - minutes * 60);
  const parts: string[] = [];
  if (hours > 0) parts.push(`${hours} h`);
  if (minutes % 60 > 0 || (hours === 0 && seconds === 0)) parts.push(`${minutes % 60} min`);
  if (seconds > 0) parts.push(`${seconds} s`);
  return `+${parts.join(" ")}`;
}
