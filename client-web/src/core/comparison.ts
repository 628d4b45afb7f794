// The second picture of a comparison: the same view of another time, of another storm or run, or with the settings of a moment ago.

import type { Camera, Scene } from "../gen/thunderhead/v1/scene_pb";
import type { StormDescription } from "../gen/thunderhead/v1/storm_pb";
import { withCamera, withOutput, withStorm, withTime } from "./scene";

export interface ComparisonChoice {
  // Absent: the storm that is shown.
  readonly stormId: string | undefined;
  // Absent: the time that is shown, and of another storm its time of the same date.
  readonly timeIndex: number | undefined;
  // Settings kept for B while those of A change; absent: B has A's.
  readonly settings: Scene | undefined;
  readonly layout: "swipe" | "side";
}

export interface ComparedWith {
  readonly camera: Camera | undefined;
  readonly size: { readonly widthPx: number; readonly heightPx: number };
  // The storm of A and, where it is known, that of B.
  readonly storm: StormDescription | undefined;
  readonly other: StormDescription | undefined;
}

// B's scene beside A's: its camera is always A's.
export function comparedScene(a: Scene, choice: ComparisonChoice, w: ComparedWith): Scene {
  const stormId = choice.stormId ?? a.stormId;
  const base = choice.settings ?? a;
  const timeIndex = timeOfB(a, choice, w);
  const storm =
    base.stormId === stormId ? withTime(base, timeIndex) : withStorm(base, stormId, timeIndex);
  const seen = w.camera === undefined ? storm : withCamera(storm, w.camera);
  return withOutput(seen, { ...w.size, jpegQuality: a.output?.jpegQuality });
}

// B's time, as an index into those of its storm.
export function timeOfB(
  a: Scene,
  choice: ComparisonChoice,
  w: Pick<ComparedWith, "storm" | "other">,
): number {
  return choice.timeIndex ?? timeOf(a, choice.stormId ?? a.stormId, w);
}

// Of another storm the time with the same date; else the one as many steps after its first.
function timeOf(
  a: Scene,
  stormId: string,
  { storm, other }: Pick<ComparedWith, "storm" | "other">,
): number {
  const index = a.timeIndex ?? 0;
  if (stormId === a.stormId || other === undefined) return index;
  const date = storm?.times[index]?.validTime;
  const same = other.times.findIndex(({ validTime }) => validTime === date);
  return same >= 0 ? same : Math.min(index, Math.max(0, other.times.length - 1));
}
