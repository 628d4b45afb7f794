// Makes display names of storms and of model runs. A run is named by the time at which it starts.
import type { StormDescription } from "../gen/thunderhead/v1/storm_pb";
import { momentOf } from "./moment";

// Returns a text like "run 2013-05-20 06:00Z". For an idealised run, which has no date, the text is
// like "run 06:00Z". The text is empty if the storm's files do not contain the run's start.
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
