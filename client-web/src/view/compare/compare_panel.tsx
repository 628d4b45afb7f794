// The panel that chooses what is compared. A shows the session, and B is the second picture. B can
// show another time, another storm or run, or A with its present settings, which B then keeps.
import { awayInWords } from "../../core/comparison";
import { timeInWords } from "../../core/moment";
import { Choice, Segments } from "../controls";
import type { Page } from "../page";
import { Popover } from "../popover";

const LAYOUTS = [
  ["swipe", "Swipe", "B lies over A; the handle moves the edge between them."],
  ["side", "Side by side", "A at the left, B at the right, with one camera."],
] as const;

const SAME = -1;

export function Compare({ page }: { page: Page }) {
  const { state, comparing } = page;
  const choice = comparing.choice.value;
  const times = (choice?.stormId === undefined ? state.storm.value : comparing.other.value)?.times;
  return (
    <Popover page={page} name="compare" title="Compare" label="Compare with another picture">
      <p class="quiet">
        A is the picture on the screen. B has the same camera. Choose how B differs:
      </p>
      <Choice
        label="Storm or run of B"
        testId="compare-storm"
        value={choice?.stormId ?? ""}
        options={[
          ["", "as A"],
          ...state.storms.value
            .filter(({ id }) => id !== state.stormId.value)
            .map(({ id, title }) => [id, title || id] as const),
        ]}
        onChange={(id) => comparing.change({ stormId: id || undefined, timeIndex: undefined })}
      />
      <Choice
        label="Time of B"
        testId="compare-time"
        value={choice?.timeIndex ?? SAME}
        options={[
          [SAME, "as A"] as const,
          ...(times ?? []).map((time, at) => [at, timeInWords(time)] as const),
        ]}
        onChange={(at) => comparing.change({ timeIndex: at === SAME ? undefined : at })}
      />
      <TimeAway page={page} />
      <Choice
        label="Settings of B"
        testId="compare-settings"
        value={choice?.settings === undefined ? "a" : "now"}
        options={[
          ["a", "as A"],
          ["now", "as they are now"],
        ]}
        onChange={(which) =>
          comparing.change({ settings: which === "now" ? state.scene.peek() : undefined })
        }
      />
      <Segments
        label="Layout"
        testId="compare-layout"
        value={choice?.layout ?? "swipe"}
        options={LAYOUTS}
        otherwise=""
        onChange={(layout) => comparing.change({ layout })}
      />
      <div class="buttons">
        {choice === undefined ? (
          <button
            type="button"
            class="primary"
            data-testid="compare-start"
            onClick={() => comparing.change({})}
          >
            Compare
          </button>
        ) : (
          <button type="button" data-testid="compare-end" onClick={() => comparing.end()}>
            End the comparison
          </button>
        )}
      </div>
      {comparing.problem.value !== undefined && (
        <p class="unmet" role="alert" data-testid="compare-problem">
          B: {comparing.problem.value}
        </p>
      )}
    </Popover>
  );
}

// Shows by how much B's time differs from A's time, or why B's times are not known.
function TimeAway({ page: { comparing } }: { page: Page }) {
  const known = comparing.other.value !== undefined;
  const words =
    comparing.undescribed.value ?? (known ? awayInWords(comparing.time.value) : undefined);
  if (words === undefined) return null;
  return (
    <p class="unmet" role="status" data-testid="compare-away">
      {words}
    </p>
  );
}
