// Names of storms: runs of one storm by when they began.
import type { StormDescription } from "../gen/thunderhead/v1/storm_pb";
import { momentOf } from "./moment";

// "run 2013-05-20 06:00Z"; of an idealised run, which has no date, "run 06:00Z"; empty where the files do not tell.
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
