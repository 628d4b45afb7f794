// The whole page. The storm fills the window. A top bar, a rail of tools, one open panel and the
// time line lie over its edges.
import { useEffect, useRef } from "preact/hooks";
import { Annotations } from "./annotations";
import { CompareView } from "./compare/compare_view";
import { ExpertDrawer } from "./drawer";
import { ErrorLine } from "./error_line";
import { Messages } from "./messages";
import { Overlay } from "./overlay";
import type { Page } from "./page";
import { Panels } from "./panels";
import { SessionBar } from "./session_bar";
import { TimeLine } from "./time_line";
import { ToolPanel, ToolRail } from "./tool_rail";
import { TopBar } from "./top_bar";

export function App({ page }: { page: Page }) {
  const { state } = page;
  const open = [
    state.tool.value !== undefined && "with-tool-open",
    state.tool.value === "time" && "with-time-open",
    state.drawerOpen.value && "with-drawer",
    state.popover.value !== undefined && "with-panel",
    page.comparing.choice.value !== undefined && "compares",
    page.comparing.choice.value?.layout === "side" && "compares-beside",
  ].filter((name) => name !== false);
  return (
    <main class={open.join(" ") || undefined}>
      <h1 class="visually-hidden">Thunderhead</h1>
      <StormCanvas page={page} />
      <CompareView page={page} />
      <Annotations state={state} comparing={page.comparing.choice.value !== undefined} />
      <Overlay state={state} marking={page.marking} marked={page.comparing.markedView.value} />
      <p id="storm-keys" class="visually-hidden">
        Arrow keys turn the view, and with Shift they move it. Plus comes nearer, and minus goes
        farther away. Question mark lists the keys.
      </p>
      <TopBar page={page} />
      <ToolRail page={page} />
      <ToolPanel page={page} />
      <ErrorLine state={state} />
      <ExpertDrawer page={page} />
      <div class="bottom">
        <SessionBar page={page} />
        <TimeLine page={page} />
      </div>
      <Panels page={page} />
      <Messages page={page} />
    </main>
  );
}

function StormCanvas({ page }: { page: Page }) {
  const inHand = page.state.session.tool.value;
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current === null) return undefined;
    return page.attachCanvas(canvas.current);
  }, [page]);
  return (
    <canvas
      ref={canvas}
      class={inHand === "camera" ? "storm" : "storm with-tool"}
      data-testid="storm-canvas"
      tabIndex={0}
      role="img"
      aria-label={page.state.description.value}
      aria-describedby="storm-keys"
    />
  );
}
