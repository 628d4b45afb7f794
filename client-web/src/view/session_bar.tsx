// The session bar. It shows the person in control and the button for control. If the user has left
// the session's view for a view of their own, it also shows the button that returns to the
// session's view.
import type { SessionState } from "../core/session_state";
import type { Page } from "./page";

const WHY_SLOWER =
  "The server renders a separate picture for each person who looks around. People who follow share one picture.";

export function SessionBar({ page }: { page: Page }) {
  const { session } = page.state;
  if (session.me.value === undefined) return null;
  return (
    <div class="session-bar" data-testid="session-bar">
      <Control page={page} />
      {session.lookingAround.value && (
        <span class="looking" title={WHY_SLOWER} data-testid="looking-around">
          {lookingAround(session.othersLookingAround.value)}
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
  if (session.steersAlone.value) return null;
  const step = controlStep(page);
  // All actions share one button, so that it keeps the keyboard focus when the action changes.
  return (
    <>
      <span class="who-steers" title={whyWaiting(session)} data-testid="who-steers">
        {whoSteers(session)}
      </span>
      <button
        type="button"
        class={step.primary ? "primary" : undefined}
        data-testid={step.testId}
        disabled={step.disabled}
        title={step.title}
        onClick={step.act}
      >
        {step.label}
      </button>
    </>
  );
}

interface ControlStep {
  readonly testId: string;
  readonly label: string;
  readonly title?: string;
  readonly primary?: boolean;
  readonly disabled?: boolean;
  act(): void;
}

// Returns the action of the control button: ask for control, take it, give it back or release it.
function controlStep({ state: { session }, actions }: Page): ControlStep {
  const letGo = () => actions.giveControl();
  if (session.steering.value && session.presenting.value)
    return {
      testId: "let-go",
      label: "Release control",
      title: session.rules.value.viewersMaySteer
        ? "No one steers then, and the first person who asks gets control"
        : "No one steers then until you give or take control",
      act: letGo,
    };
  if (session.steering.value)
    return { testId: "give-back", label: "Give control back", act: letGo };
  if (session.presenting.value)
    return {
      testId: "take-control",
      label: "Take control",
      primary: true,
      act: () => actions.takeControl(),
    };
  const asked = session.iAsk.value;
  const locked = session.rules.value.controlLocked === true;
  const ask = { testId: "ask-control", act: () => actions.askControl() };
  if (locked)
    return {
      ...ask,
      label: "Ask to steer",
      title: "The presenter has locked control",
      disabled: true,
    };
  if (asked) return { ...ask, label: "Asked to steer …", disabled: true };
  if (session.steersWhoAsks.value)
    return {
      ...ask,
      label: "Steer",
      title: "No one steers. The first person who asks gets control.",
    };
  return { ...ask, label: "Ask to steer" };
}

function whoSteers(session: SessionState): string {
  if (session.steering.value) return "You steer";
  const steerer = session.steerer.value;
  if (steerer !== undefined) return `${session.nameOf(steerer)} steers`;
  const awaited = session.awaited.value;
  return awaited === undefined
    ? "No one steers"
    : `Waiting for ${session.nameOf(awaited)} to come back`;
}

// Describes why control is reserved for a person; undefined if it is not reserved.
function whyWaiting(session: SessionState): string | undefined {
  if (session.awaited.value === undefined) return undefined;
  const who =
    "A person who steered and has left, or has lost the connection, has some seconds to come back.";
  return session.presenting.value
    ? `${who} After that, the presenter has control; you need not wait to take it`
    : `${who} After that, the presenter has control`;
}

function lookingAround(others: number): string {
  return others === 0
    ? "Looking around"
    : `${others + 1} look around: pictures may arrive more slowly`;
}

function announcement(page: Page): string {
  const { session } = page.state;
  if (session.answersAsking.value && session.asking.value.length > 0) {
    const names = session.asking.value.map((person) => session.nameOf(person));
    return `${names.join(" and ")} ${names.length > 1 ? "ask" : "asks"} to steer. See People.`;
  }
  if (session.steering.value && session.alone.value) return "";
  return session.people.value.length === 0 ? "" : `${whoSteers(session)}.`;
}
