// The whole page: the storm fills the window, everything else lies over its edges.
import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { PageState } from "../core/state";
import { Overlay } from "./overlay";
import type { Page } from "./page";
import { Panel } from "./panel";
import { Asking, PeopleList } from "./people";
import { Readout } from "./readout";
import { SessionBar } from "./session_bar";
import { Share } from "./share";
import { SignIn } from "./sign_in";
import { TimeBar } from "./time_bar";

const SHORT_WAIT_S = 3;

export function App({ page }: { page: Page }) {
  const { state } = page;
  return (
    <main class={state.panelOpen.value ? "with-panel" : undefined}>
      <h1 class="visually-hidden">Thunderhead</h1>
      <StormCanvas page={page} />
      <Overlay state={state} marking={page.marking} />
      <Readout state={state} />
      <Panel page={page} />
      <div class="bottom">
        <SessionBar page={page} />
        <TimeBar page={page} />
      </div>
      <TopBar page={page} />
      <div class="messages">
        <ConnectionBanner state={state} />
        <SignIn page={page} />
        <SessionEnded page={page} />
        <Asking page={page} />
        <Notices state={state} />
      </div>
    </main>
  );
}

function TopBar({ page }: { page: Page }) {
  const { state } = page;
  const { session } = state;
  const popover = state.popover.value;
  const asking = session.answersAsking.value ? session.asking.value.length : 0;
  const people = session.people.value.length;
  return (
    <>
      <nav class="top-bar" aria-label="Session and settings">
        <button
          type="button"
          data-testid="share"
          aria-haspopup="dialog"
          aria-expanded={popover === "share"}
          aria-controls="share"
          disabled={session.viewerKey.value === undefined || session.ended.value !== undefined}
          onClick={() => page.togglePopover("share")}
        >
          Share
        </button>
        <button
          type="button"
          data-testid="people"
          aria-haspopup="dialog"
          aria-expanded={popover === "people"}
          aria-controls="people"
          onClick={() => page.togglePopover("people")}
        >
          People{people > 0 && ` ${people}`}
          {asking > 0 && (
            <span class="badge" data-testid="asking-badge">
              {asking}
              <span class="visually-hidden"> ask to steer</span>
            </span>
          )}
        </button>
        <button
          type="button"
          data-testid="panel-toggle"
          aria-expanded={state.panelOpen.value}
          aria-controls="panel"
          title="Show or hide the settings (P)"
          onClick={() => page.togglePanel()}
        >
          {state.panelOpen.value ? "Hide settings" : "Settings"}
        </button>
      </nav>
      {popover === "share" && <Share page={page} />}
      {popover === "people" && <PeopleList page={page} />}
    </>
  );
}

function StormCanvas({ page }: { page: Page }) {
  const tool = page.state.session.tool.value;
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current === null) return undefined;
    return page.attachCanvas(canvas.current);
  }, [page]);
  return (
    <canvas
      ref={canvas}
      class={tool === "camera" ? "storm" : "storm with-tool"}
      data-testid="storm-canvas"
      tabIndex={0}
      role="img"
      aria-label="The storm. Arrow keys turn it, with shift they move it, plus and minus come nearer and go farther."
    />
  );
}

function ConnectionBanner({ state }: { state: PageState }) {
  const connection = state.connection.value;
  return (
    <div role="status" aria-live="polite">
      {connection.kind === "connecting" && (
        <p class="banner waiting" data-testid="connecting">
          Opening the storm …
        </p>
      )}
      {connection.kind === "lost" && (
        <p class="banner lost" data-testid="connection-lost">
          {connection.reason}.{" "}
          <Reconnecting key={connection.attempts} inMs={connection.retryInMs} />
        </p>
      )}
    </div>
  );
}

// Counts the seconds to the next attempt, where they are many.
function Reconnecting({ inMs }: { inMs: number }) {
  const left = useSignal(Math.ceil(inMs / 1000));
  useEffect(() => {
    const timer = setInterval(() => {
      left.value -= 1;
    }, 1000);
    return () => clearInterval(timer);
  }, [left]);
  return left.value > SHORT_WAIT_S ? <>Trying again in {left} s …</> : <>Reconnecting …</>;
}

function SessionEnded({ page }: { page: Page }) {
  const { ended } = page.state.session;
  if (ended.value === undefined) return null;
  return (
    <section class="ended" aria-label="The session has ended" data-testid="session-ended">
      <p>{ended.value.replace(/\.$/, "")}.</p>
      <button type="button" data-testid="open-new" onClick={() => page.actions.openNewSession()}>
        Open a new session with this scene
      </button>
    </section>
  );
}

function Notices({ state }: { state: PageState }) {
  return (
    <ul class="notices" data-testid="notices">
      {state.notices.value.map((notice) => (
        <li
          key={notice.subject}
          class={`notice ${notice.severity}`}
          role={notice.severity === "problem" ? "alert" : "status"}
          data-subject={notice.subject}
        >
          <span class="notice-text">{notice.text}</span>
          <button
            type="button"
            class="close"
            aria-label="Dismiss"
            onClick={() => state.dismiss(notice.subject)}
          >
            ×
          </button>
        </li>
      ))}
    </ul>
  );
}
