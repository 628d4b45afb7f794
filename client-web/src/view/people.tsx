// The list of the people in the session: their names and roles, who is in control, and who asks to
// steer.
import { LONGEST_NAME } from "../core/own_keys";
import { type Person, Role } from "../gen/thunderhead/v1/interact_pb";
import type { Page } from "./page";
import { Popover } from "./popover";

export function PeopleList({ page }: { page: Page }) {
  const { session } = page.state;
  const asking = session.asking.value;
  const others = session.people.value.filter((person) => !asking.includes(person));
  return (
    <Popover page={page} name="people" title="People" label="People in this session">
      <OwnName page={page} />
      <ul data-testid="people-list">
        {[...asking, ...others].map((person) => (
          <PersonRow key={person.viewerId} page={page} person={person} />
        ))}
      </ul>
    </Popover>
  );
}

function OwnName({ page }: { page: Page }) {
  return (
    <label class="own-name">
      Your name
      <input
        type="text"
        maxLength={LONGEST_NAME}
        data-testid="own-name"
        placeholder="None"
        defaultValue={page.actions.name}
        onChange={(event) => page.actions.rename(event.currentTarget.value)}
      />
    </label>
  );
}

function PersonRow({ page, person }: { page: Page; person: Person }) {
  const { session } = page.state;
  const { viewerId } = person;
  const steers = session.steeringId.value === viewerId;
  const notes = [
    person.role === Role.PRESENTER && person.name !== "" && "presenter",
    person.hidden && "away",
    !person.follows && "looking around",
    person.asksControl && "asks to steer",
  ].filter((note) => note !== false);
  const answers = session.answersAsking.value && person.asksControl;
  const gives =
    session.answersAsking.value && !person.asksControl && !steers && !session.isMe(viewerId);
  return (
    <li class={steers ? "steers" : undefined} data-testid="person">
      <span class="person-name">
        {session.nameOf(person)}
        {session.isMe(viewerId) && <span class="quiet"> (you)</span>}
        {steers && <span class="tag">steers</span>}
        {notes.length > 0 && <span class="quiet"> {notes.join(", ")}</span>}
      </span>
      {answers && <AnswerButtons page={page} person={person} testId="give" />}
      {gives && (
        <button
          type="button"
          class="give-unasked"
          data-testid="give-unasked"
          aria-label={`Give control to ${session.nameOf(person)}`}
          onClick={() => page.actions.giveControl(viewerId)}
        >
          Give control
        </button>
      )}
    </li>
  );
}

// The people who ask to steer, with buttons to answer them. Only people who may answer see this. A
// request expires after 20 seconds.
export function Asking({ page }: { page: Page }) {
  const { session } = page.state;
  if (!session.answersAsking.value) return null;
  return (
    <>
      {session.asking.value.map((person) => (
        <p key={person.viewerId} class="banner asking" data-testid="asks">
          <span>{session.nameOf(person)} asks to steer</span>
          <AnswerButtons page={page} person={person} testId="asks-give" />
        </p>
      ))}
    </>
  );
}

function AnswerButtons(props: { page: Page; person: Person; testId: string }) {
  const { page, person, testId } = props;
  const name = page.state.session.nameOf(person);
  return (
    <span class="person-buttons">
      <button
        type="button"
        data-testid={testId}
        aria-label={`Give control to ${name}`}
        onClick={() => page.actions.giveControl(person.viewerId)}
      >
        Give
      </button>
      <button
        type="button"
        data-testid={`${testId}-not`}
        aria-label={`Do not give control to ${name} now`}
        onClick={() => page.actions.refuseControl(person.viewerId)}
      >
        Not now
      </button>
    </span>
  );
}
