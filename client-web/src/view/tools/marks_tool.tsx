// Marks that all people see over the picture: pen, arrow, text and a pointer, at their positions in
// the world.
import { leftOutInWords, MAX_LETTERS } from "../../core/lettering";
import type { Tool } from "../../core/session_state";
import { Icon } from "../icons";
import type { Page } from "../page";

type InHand = Exclude<Tool, "camera">;

const IN_HAND: readonly (readonly [InHand, string, string])[] = [
  ["pen", "Pen", "Draw on the storm."],
  ["arrow", "Arrow", "Drag from its tail to its tip."],
  ["text", "Text", "Click where it begins."],
  ["pointer", "Pointer", "Everyone sees where you point."],
];

const IN_THE_MIDDLE: Readonly<Record<InHand, string>> = {
  pen: "Ring around the middle",
  arrow: "Arrow to the middle",
  text: "Write it in the middle",
  pointer: "Point at the middle",
};

export function MarksTool({ page }: { page: Page }) {
  const { session } = page.state;
  const inHand = session.tool.value;
  const mine = session.marks.value.some(
    (mark) => session.presenting.value || session.isMe(mark.viewerId),
  );
  const leftOut = leftOutInWords(page.marking.words.value.trim());
  if (!session.mayMark.value)
    return <p class="quiet">The presenter has not allowed viewers to point and draw.</p>;
  return (
    <>
      <fieldset class="hand">
        <legend class="visually-hidden">In the hand</legend>
        {IN_HAND.map(([tool, label, about]) => (
          <button
            key={tool}
            type="button"
            data-testid={`tool-${tool}`}
            aria-pressed={inHand === tool}
            title={about}
            onClick={() => page.takeInHand(tool)}
          >
            <Icon name={tool} />
            {label}
          </button>
        ))}
      </fieldset>
      <p class="quiet" role="status">
        {IN_HAND.find(([tool]) => tool === inHand)?.[2] ??
          "Everyone in the session sees the marks, which stay at their places on the storm or the ground."}
      </p>
      {inHand === "text" && (
        <input
          type="text"
          aria-label="Words to write"
          placeholder="Words to write"
          data-testid="mark-words"
          maxLength={MAX_LETTERS}
          value={page.marking.words.value}
          onInput={(event) => {
            page.marking.words.value = event.currentTarget.value;
          }}
        />
      )}
      {inHand === "text" && leftOut !== undefined && (
        <p class="unmet" role="status" data-testid="mark-left-out">
          {leftOut}
        </p>
      )}
      <div class="buttons">
        {inHand !== "camera" && (
          <button
            type="button"
            data-testid="mark-middle"
            onClick={() => page.marking.markMiddle(inHand)}
          >
            {IN_THE_MIDDLE[inHand]}
          </button>
        )}
        {mine && (
          <button type="button" data-testid="clear-marks" onClick={() => page.actions.eraseMarks()}>
            {session.presenting.value ? "Erase all marks" : "Erase my marks"}
          </button>
        )}
      </div>
    </>
  );
}
