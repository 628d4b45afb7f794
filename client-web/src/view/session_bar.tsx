// Who steers, and the way back from looking around.
import type { Page } from "./page";

export function SessionBar({ page }: { page: Page }) {
  const { session } = page.state;
  if (session.me.value === undefined) return null;
  return (
    <div class="session-bar" data-testid="session-bar">
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
