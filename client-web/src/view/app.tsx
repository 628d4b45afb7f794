// The whole page: the storm fills the window, everything else lies over its edges.
import "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { PageState } from "../core/state";
import type { Page } from "./page";
import { Panel } from "./panel";
import { Readout } from "./readout";
import { TimeBar } from "./time_bar";

export function App({ page }: { page: Page }) {
  const { state } = page;
  return (
    <main class={state.panelOpen.value ? "with-panel" : undefined}>
      <h1 class="visually-hidden">Thunderhead</h1>
      <StormCanvas page={page} />
      <Readout state={state} />
      <Panel page={page} />
      <TimeBar page={page} />
      <div class="messages">
        <ConnectionBanner state={state} />
        <Notices state={state} />
      </div>
    </main>
  );
}

function StormCanvas({ page }: { page: Page }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current === null) return undefined;
    return page.attachCanvas(canvas.current);
  }, [page]);
  return (
    <canvas
      ref={canvas}
      class="storm"
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
          {connection.reason}. Trying again …
        </p>
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
          <span>{notice.text}</span>
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
