// The error of a picture in words.
import type { AccuracyReport } from "../gen/thunderhead/v1/frame_pb";
import { formatNumber } from "./units";

// "measured: 8.1 to 9.4 %", or where the figure comes from until it is.
export function errorSource(report: AccuracyReport): string {
  if (report.errorLow === undefined || report.errorHigh === undefined)
    return "from a table, until measured";
  return `measured: ${formatNumber(100 * report.errorLow)} to ${formatNumber(100 * report.errorHigh)} %`;
}

// "2 % too dark"; empty where it is not measured.
export function biasInWords(report: AccuracyReport): string {
  if (report.bias === undefined) return "";
  const amount = formatNumber(100 * Math.abs(report.bias));
  return `${amount} % too ${report.bias < 0 ? "dark" : "bright"}`;
}
