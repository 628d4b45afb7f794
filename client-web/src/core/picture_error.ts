// Describes the error of a picture as text.
import type { AccuracyReport } from "../gen/thunderhead/v1/frame_pb";
import { formatNumber } from "./units";

// Returns a text like "measured: 8.1 to 9.4 %", the interval of the measured error. Before the
// error is measured, the text says that the error comes from a table.
export function errorSource(report: AccuracyReport): string {
  if (report.errorLow === undefined || report.errorHigh === undefined)
    return "from a table, until measured";
  return `measured: ${formatNumber(100 * report.errorLow)} to ${formatNumber(100 * report.errorHigh)} %`;
}

// Returns a text like "2 % too dark"; empty if the bias is not measured.
export function biasInWords(report: AccuracyReport): string {
  if (report.bias === undefined) return "";
  const amount = formatNumber(100 * Math.abs(report.bias));
  return `${amount} % too ${report.bias < 0 ? "dark" : "bright"}`;
}
