// Messages over the picture: the state of the connection, requests for control, notices, and the
// end of the session.
import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { standingAzimuthDeg } from "../core/camera";
import { withSun } from "../core/scene";
import type { PageState } from "../core/state";
import { daylight, NIGHT_BELOW_DEG } from "../core/sun";
import { Sun_Source } from "../gen/thunderhead/v1/scene_pb";
import type { Page } from "./page";
import { Asking } from "./people";
import { SignIn } from "./sign_in";

const SHORT_WAIT_S = 3;

export function Messages({ page }: { page: Page }) {
  const { state } = page;
  return (
    <div class="messages">
      <ConnectionBanner state={state} />
      <SignIn page={page} />
      <SessionEnded page={page} />
      <Asking page={page} />
      <Night state={state} />
      <Notices state={state} />
    </div>
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

// Shows that the connection was lost, and counts down the seconds to the next attempt if the wait
// is long.
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

// Explains that the picture is dark, and offers daylight.
function Night({ state }: { state: PageState }) {
  if (state.frame.value === undefined) return null;
  const { elevationDeg } = state.sunDirection.value;
  if (elevationDeg >= NIGHT_BELOW_DEG) return null;
  const standing = standingAzimuthDeg(state.pose.value);
  const byHand = { ...daylight(standing ?? 0), source: Sun_Source.BY_HAND };
  return (
    <div class="banner night" role="status" data-testid="night">
      <p>It is night at the storm: the sun is {Math.round(-elevationDeg)}° below the horizon.</p>
      {state.session.editBlock.value === undefined && (
        <button
          type="button"
          data-testid="show-by-day"
          onClick={() => state.edit((scene) => withSun(scene, byHand))}
        >
          Show it by day
        </button>
      )}
    </div>
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
