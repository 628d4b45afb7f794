// The second picture of a comparison, called B; the first picture, called A, shows the session. B
// shows the same view as A, but at another time, of another storm or run, or with earlier settings.

import type { Camera, Scene } from "../gen/thunderhead/v1/scene_pb";
import type { StormDescription } from "../gen/thunderhead/v1/storm_pb";
import { isSameDomain, laterByS } from "./domain";
import { nearestTime, sameNumber } from "./nearest_time";
import { withCamera, withOutput, withRun, withStorm } from "./scene";
import { formatElapsed } from "./units";

export interface ComparisonChoice {
  // If undefined, B shows A's storm.
  readonly stormId: string | undefined;
  // If undefined, B shows A's time. If B shows another storm, it then shows the time with the
  // nearest date.
  readonly timeIndex: number | undefined;
  // Settings that B keeps while the settings of A change. If undefined, B uses A's settings.
  readonly settings: Scene | undefined;
  readonly layout: "swipe" | "side";
}

export interface ComparedWith {
  readonly camera: Camera | undefined;
  readonly size: { readonly widthPx: number; readonly heightPx: number };
  // The storm of A and, if it is known, the storm of B.
  readonly storm: StormDescription | undefined;
  readonly other: StormDescription | undefined;
}

// Returns B's scene. Its camera is always A's.
export function comparedScene(a: Scene, choice: ComparisonChoice, w: ComparedWith): Scene {
  const stormId = choice.stormId ?? a.stormId;
  const base = choice.settings ?? a;
  const timeIndex = timeOfB(a, choice, w).index;
  // Another run of the same model keeps the settings.
  const related = base.stormId === stormId || isSameDomain(w.storm, w.other);
  const laterS = base.stormId === stormId ? 0 : laterByS(w.storm, w.other);
  const storm = related
    ? withRun(base, stormId, timeIndex, laterS)
    : withStorm(base, stormId, timeIndex);
  const seen = w.camera === undefined ? storm : withCamera(storm, w.camera);
  return withOutput(seen, { ...w.size, jpegQuality: a.output?.jpegQuality });
}

// B's time as an index into its storm's times, and its difference from A's time.
export interface TimeOfB {
  readonly index: number;
  // Seconds from A's time to B's time, negative if B is earlier. It is 0 if B's time was chosen
  // explicitly. It is undefined if the dates cannot be compared. B then has A's index, limited to
  // the indices of B's times.
  readonly awayS: number | undefined;
}

export function timeOfB(
  a: Scene,
  choice: ComparisonChoice,
  w: Pick<ComparedWith, "storm" | "other">,
): TimeOfB {
  if (choice.timeIndex !== undefined) return { index: choice.timeIndex, awayS: 0 };
  const index = a.timeIndex ?? 0;
  const stormId = choice.stormId ?? a.stormId;
  if (stormId === a.stormId) return { index, awayS: 0 };
  // Until B's storm is described, B uses the same time index as A.
  if (w.other === undefined) return { index, awayS: undefined };
  const { times } = w.other;
  const validTime = w.storm?.times[index]?.validTime ?? "";
  return nearestTime(validTime, times) ?? { index: sameNumber(index, times), awayS: undefined };
}

// Returns a sentence about how far B's time is from A's time. Returns undefined if the two times
// are the same, or if B's time was chosen explicitly.
export function awayInWords({ awayS }: TimeOfB): string | undefined {
  if (awayS === 0) return undefined;
  if (awayS === undefined)
    return "The dates of A and B cannot be compared, so B shows the time with the same number.";
  const duration = formatElapsed(Math.abs(awayS)).slice(1);
  return `B has no such valid time, so it shows the nearest one, ${duration} ${awayS < 0 ? "earlier" : "later"}.`;
}
