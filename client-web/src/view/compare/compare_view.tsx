// The second picture of a comparison (B) next to or over the session's picture (A), the names of
// both pictures, and the handle between them.
import { useEffect, useRef } from "preact/hooks";
import { timeInWords } from "../../core/moment";
import { nameOfStorm } from "../../core/storm_names";
import type { StormDescription } from "../../gen/thunderhead/v1/storm_pb";
import type { Page } from "../page";

export function CompareView({ page }: { page: Page }) {
  const choice = page.comparing.choice.value;
  const canvas = useRef<HTMLCanvasElement>(null);
  const shown = choice !== undefined;
  useEffect(() => {
    if (!shown || canvas.current === null) return undefined;
    return page.comparing.attach(canvas.current);
  }, [page, shown]);
  if (choice === undefined) return null;
  const swipes = choice.layout === "swipe";
  const share = page.comparing.swipe.value;
  const clip = swipes ? { clipPath: `inset(0 0 0 ${(100 * share).toFixed(2)}%)` } : {};
  const edge = swipes ? `${100 * share}%` : "calc(var(--from) + var(--beside))";
  const names = namesOf(page);
  return (
    <>
      <canvas
        ref={canvas}
        class={swipes ? "storm compared" : "storm compared beside"}
        style={clip}
        data-testid="compared-canvas"
        role="img"
        aria-label={`To compare: ${names.b}`}
      />
      {/* Each picture's name is in its half, and no wider than the free part of that half. */}
      <div class="half" style={{ clipPath: `inset(0 calc(100% - ${edge}) 0 0)`, "--edge": edge }}>
        <p class="compared-name a" data-testid="name-a">
          A · {names.a}
        </p>
      </div>
      <div class="half" style={{ clipPath: `inset(0 0 0 ${edge})`, "--edge": edge }}>
        <p class="compared-name b" data-testid="name-b">
          B · {names.b}
          <Missing page={page} />
        </p>
      </div>
      {swipes && (
        <input
          type="range"
          class="swipe"
          aria-label="Edge between A and B"
          data-testid="swipe"
          min={0}
          max={100}
          value={100 * share}
          style={{ "--edge": `${100 * share}%` }}
          onInput={(event) => {
            page.comparing.swipe.value = event.currentTarget.valueAsNumber / 100;
          }}
        />
      )}
    </>
  );
}

// Shows why B's picture is missing or differs from the request.
function Missing({ page: { comparing } }: { page: Page }) {
  const why = comparing.interrupted.value ?? comparing.problem.value;
  if (why === undefined) return null;
  return (
    <span class="unmet" role="status" data-testid="missing-b">
      {why}
    </span>
  );
}

// Returns names that describe the difference between A and B.
function namesOf({ state, comparing }: Page): { readonly a: string; readonly b: string } {
  const choice = comparing.choice.value;
  const index = comparing.time.value.index;
  const aTime = timeInWords(state.storm.value?.times[state.timeIndex.value]);
  const settings = choice?.settings === undefined ? "" : ", kept settings";
  if (choice?.stormId === undefined)
    return { a: aTime, b: `${timeInWords(state.storm.value?.times[index])}${settings}` };
  const named = (storm: StormDescription | undefined, id: string) =>
    storm === undefined ? id : nameOfStorm(storm);
  const other = comparing.other.value;
  const a = { storm: named(state.storm.value, state.stormId.value), time: aTime };
  const b = { storm: named(other, choice.stormId), time: timeInWords(other?.times[index]) };
  return {
    a: `${a.storm}, ${a.time}`,
    b: `${b.storm}${b.time === "" ? "" : `, ${b.time}`}${settings}`,
  };
}
