// What everybody sees over the picture: a pen and a pointer.
import type { Tool } from "../../core/session_state";
import { Icon, type IconName } from "../icons";
import type { Page } from "../page";

const IN_HAND: readonly (readonly [Exclude<Tool, "camera">, IconName, string, string])[] = [
  ["pen", "pen", "Pen", "Draws a line on the storm."],
  ["pointer", "pointer", "Pointer", "Shows everybody where you point."],
];

export function MarksTool({ page }: { page: Page }) {
  const { session } = page.state;
  const inHand = session.tool.value;
  const mine = session.marks.value.some(
    (mark) => session.presenting.value || session.isMe(mark.viewerId),
  );
  if (!session.mayMark.value)
    return <p class="quiet">The presenter has not allowed viewers to point and draw.</p>;
  return (
    <>
      <div class="hand" role="group" aria-label="In the hand">
        {IN_HAND.map(([tool, icon, label, about]) => (
          <button
            key={tool}
            type="button"
            data-testid={`tool-${tool}`}
            aria-pressed={inHand === tool}
            title={about}
            onClick={() => page.takeInHand(tool)}
          >
            <Icon name={icon} />
            {label}
          </button>
        ))}
      </div>
      <p class="quiet">
        {IN_HAND.find(([tool]) => tool === inHand)?.[3] ?? "Everybody in the session sees them."}
      </p>
      {mine && (
        <button type="button" data-testid="clear-marks" onClick={() => page.actions.eraseMarks()}>
          {session.presenting.value ? "Erase all marks" : "Erase my marks"}
        </button>
      )}
    </>
  );
}
