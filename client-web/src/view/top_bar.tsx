// The top bar. It shows the storm, the run, the valid time in UTC and local time, the lead time,
// and the connection. It also has the buttons for people, comparing, saving, sharing and full
// screen.

import type { PanelName } from "../core/tools";
import { formatElapsed } from "../core/units";
import { toggleFullScreen } from "./full_screen";
import { Icon, type IconName } from "./icons";
import { workInWords } from "./keep/keeper";
import type { Page } from "./page";
import { Connection } from "./readout";

export function TopBar({ page }: { page: Page }) {
  const { state } = page;
  return (
    <header class="top-bar" data-testid="top-bar">
      <div class="named-storm">
        <Storm page={page} />
        <Assumptions page={page} />
      </div>
      <When page={page} />
      <div class="top-buttons">
        <Connection state={state} />
        <PanelButton page={page} name="people" testId="people" icon="people" label={people(page)}>
          <Asked page={page} />
        </PanelButton>
        <PanelButton page={page} name="compare" testId="compare" label="Compare" />
        <AtWork page={page} />
        <PanelButton page={page} name="keep" testId="keep" label="Save" />
        <PanelButton page={page} name="share" testId="share" label="Share" primary />
        <FullScreen />
      </div>
    </header>
  );
}

// The storm's name. A click lists the server's storms.
function Storm({ page }: { page: Page }) {
  const { state } = page;
  return (
    <button
      type="button"
      class="storm-name"
      data-testid="storms"
      aria-haspopup="dialog"
      aria-expanded={state.popover.value === "storms"}
      aria-controls="storms"
      title="Choose another storm, or make a cloud"
      onClick={() => page.togglePopover("storms")}
    >
      <strong>{state.title.value}</strong>
      {state.run.value !== "" && (
        <span class="quiet run" data-testid="run">
          {state.run.value}
        </span>
      )}
    </button>
  );
}

// The number of assumptions about the storm's files. A click lists them.
function Assumptions({ page }: { page: Page }) {
  const assumptions = page.state.assumptions.value;
  if (assumptions.length === 0) return null;
  const word = assumptions.length === 1 ? "assumption" : "assumptions";
  return (
    <details class="assumptions" data-testid="assumptions">
      <summary
        title="What the server assumed because the files do not say it"
        aria-label={`${assumptions.length} ${word}`}
      >
        <span class="count">{assumptions.length}</span>
        <span class="word"> {word}</span>
      </summary>
      <ul class="assumptions-body">
        {assumptions.map((text) => (
          <li key={text}>{text}</li>
        ))}
      </ul>
    </details>
  );
}

function When({ page }: { page: Page }) {
  const { state } = page;
  const time = state.shownTime.value;
  const moment = state.moment.value;
  if (time === undefined || moment === undefined) return <span class="when" />;
  return (
    <output class="when" data-testid="top-time">
      <span class="clock">
        {moment.date !== "" && <span class="date">{moment.date} </span>}
        {moment.clock}
      </span>
      <span class="quiet lead">{formatElapsed(state.leadS.value)}</span>
      {moment.local !== undefined && (
        <span class="quiet local" data-testid="local-time">
          {moment.local}
        </span>
      )}
      {time.deleted && <span class="quiet">deleted, shown from memory</span>}
    </output>
  );
}

function people(page: Page): string {
  const count = page.state.session.people.value.length;
  return count === 1 ? "1 person" : `${count} people`;
}

function Asked({ page }: { page: Page }) {
  const { session } = page.state;
  const asking = session.answersAsking.value ? session.asking.value.length : 0;
  const count = session.people.value.length;
  return (
    <>
      <span aria-hidden="true">{count > 0 ? count : ""}</span>
      {asking > 0 && (
        <span class="badge" data-testid="asking-badge">
          {asking}
          <span class="visually-hidden"> ask to steer</span>
        </span>
      )}
    </>
  );
}

interface PanelButtonProps {
  readonly page: Page;
  readonly name: PanelName;
  readonly testId: string;
  readonly label: string;
  readonly icon?: IconName;
  readonly primary?: boolean;
  readonly children?: preact.ComponentChildren;
}

function PanelButton(props: PanelButtonProps) {
  const { page, name, testId, label, icon, primary, children } = props;
  const { session, popover } = page.state;
  const needsSession = name === "share" || name === "compare";
  return (
    <button
      type="button"
      class={primary ? "pill primary" : `pill ${name}-button`}
      data-testid={testId}
      aria-haspopup="dialog"
      aria-expanded={popover.value === name}
      aria-controls={name}
      title={label}
      disabled={
        needsSession && (session.viewerKey.value === undefined || session.ended.value !== undefined)
      }
      onClick={() => page.togglePopover(name)}
    >
      {icon === undefined ? label : <Icon name={icon} />}
      {icon !== undefined && <span class="visually-hidden">{label}</span>}
      {children}
    </button>
  );
}

// The progress of a movie or a picture, while the panel in which it was requested is closed.
function AtWork({ page }: { page: Page }) {
  const { keeper, state } = page;
  const work = keeper.work.value;
  if (work === undefined || state.popover.value === "keep") return null;
  return (
    <span class="at-work" data-testid="at-work">
      <span role="status">{workInWords(work)}</span>
      <button
        type="button"
        class="close"
        data-testid="at-work-cancel"
        aria-label={`Cancel: ${work.what}`}
        title="Cancel"
        onClick={() => keeper.cancel()}
      >
        ×
      </button>
    </span>
  );
}

function FullScreen() {
  // Some browsers, such as those of phones, have no full screen.
  if (!document.fullscreenEnabled) return null;
  return (
    <button
      type="button"
      class="pill full-screen"
      data-testid="full-screen"
      aria-label="Full screen"
      title="Full screen (W)"
      onClick={() => toggleFullScreen()}
    >
      <Icon name="expand" />
    </button>
  );
}
