// Names of storms. Runs of one storm are named by their start.
import type { StormDescription } from "../gen/thunderhead/v1/storm_pb";
import { momentOf } from "./moment";

// Returns a text like "run 2013-05-20 06:00Z". For an idealised run, which has no date, it is like
// "run 06:00Z". It is empty if the files do not contain the start.
export function nameOfRun(runStart: string): string {
  if (runStart === "") return "";
  const { date, clock } = momentOf(runStart, "", undefined);
  return /^\d{4}/.test(date) ? `run ${date} ${clock}` : `run ${clock}`;
}

export function nameOfStorm({
  id,
  title,
  runStart,
}: Pick<StormDescription, "id" | "title" | "runStart">): string {
  return [title || id, nameOfRun(runStart)].filter((part) => part !== "").join(" · ");
}
