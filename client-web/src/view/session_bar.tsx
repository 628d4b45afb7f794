// The tools that everybody sees, who steers, and the way back from looking around.
import type { Tool } from "../core/session_state";
import type { Page } from "./page";

export function SessionBar({ page }: { page: Page }) {
  const { session } = page.state;
  if (session.me.value === undefined) return null;
  return (
    <div class="session-bar" data-testid="session-bar">
      {session.mayMark.value && <Tools page={page} />}
      <Control page={page} />
      {session.lookingAround.value && (
        <span class="looking" data-testid="looking-around">
          Looking around
          <button type="button" class="primary" data-testid="follow" onClick={() => page.follow()}>
            Back to presenter
          </button>
        </span>
      )}
      <p class="visually-hidden" role="status" aria-live="polite" data-testid="announcements">
        {announcement(page)}
      </p>
    </div>
  );
}

const TOOLS: readonly (readonly [Exclude<Tool, "camera">, string, string, string])[] = [
  [
    "pointer",
    "Laser pointer",
    "L",
    "M8 5a3 3 0 1 0 0 6 3 3 0 0 0 0-6zM7.4 0h1.2v3H7.4zM7.4 13h1.2v3H7.4zM0 7.4h3v1.2H0zM13 7.4h3v1.2h-3z",
  ],
  ["pen", "Pen", "D", "M11.5 1.5l3 3L5.5 13.5 1.5 14.5 2.5 10.5z"],
];

function Tools({ page }: { page: Page }) {
  const { session } = page.state;
  const marks = session.marks.value.some(
    (mark) => session.presenting.value || session.isMe(mark.viewerId),
  );
  return (
    <span class="tools" role="toolbar" aria-label="Tools that everybody sees">
      {TOOLS.map(([tool, label, key, icon]) => (
        <button
          key={tool}
          type="button"
          class="tool"
          data-testid={`tool-${tool}`}
          aria-label={label}
          aria-pressed={session.tool.value === tool}
          title={`${label} (${key})`}
          onClick={() => page.toggleTool(tool)}
        >
          <svg viewBox="0 0 16 16" aria-hidden="true">
            <path d={icon} />
          </svg>
        </button>
      ))}
      {marks && (
        <button type="button" data-testid="clear-marks" onClick={() => page.actions.eraseMarks()}>
          Clear marks
        </button>
      )}
    </span>
  );
}

function Control({ page }: { page: Page }) {
  const { session } = page.state;
  const steerer = session.steerer.value;
  if (session.steering.value) {
    if (session.presenting.value) return session.alone.value ? null : <Said text="You steer" />;
    return (
      <button type="button" data-testid="give-back" onClick={() => page.actions.giveControl()}>
        You steer · give back
      </button>
    );
  }
  return (
    <>
      <Said text={steerer === undefined ? "Nobody steers" : `${session.nameOf(steerer)} steers`} />
      {session.presenting.value ? (
        <button
          type="button"
          class="primary"
          data-testid="take-control"
          onClick={() => page.actions.takeControl()}
        >
          Take control
        </button>
      ) : (
        <button
          type="button"
          data-testid="ask-control"
          disabled={session.iAsk.value || session.rules.value.controlLocked === true}
          title={session.rules.value.controlLocked ? "The presenter has locked control" : undefined}
          onClick={() => page.actions.askControl()}
        >
          {session.iAsk.value ? "Asked to steer …" : "Ask to steer"}
        </button>
      )}
    </>
  );
}

function Said({ text }: { text: string }) {
  return (
    <span class="who-steers" data-testid="who-steers">
      {text}
    </span>
  );
}

function announcement(page: Page): string {
  const { session } = page.state;
  if (session.answersAsking.value && session.asking.value.length > 0) {
    const names = session.asking.value.map((person) => session.nameOf(person));
    return `${names.join(" and ")} ${names.length > 1 ? "ask" : "asks"} to steer. See People.`;
  }
  const steerer = session.steerer.value;
  if (session.steering.value) return session.alone.value ? "" : "You steer.";
  return steerer === undefined ? "" : `${session.nameOf(steerer)} steers.`;
}
