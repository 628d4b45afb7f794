// The rail of tools, and the panel of the open tool. In a wide window the panel is next to the
// rail. In a narrow window it is at the bottom.
import type { ComponentChildren } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import { TOOL_NAMES, TOOL_TEXTS, type ToolName } from "../core/tools";
import { Icon } from "./icons";
import type { Page } from "./page";
import { FieldsTool } from "./tools/fields_tool";
import { LightTool } from "./tools/light_tool";
import { LookTool } from "./tools/look_tool";
import { MapTool } from "./tools/map_tool";
import { MarksTool } from "./tools/marks_tool";
import { ProbeTool } from "./tools/probe_tool";
import { TimeTool } from "./tools/time_tool";

const CONTENTS: Readonly<Record<ToolName, (props: { page: Page }) => ComponentChildren>> = {
  map: MapTool,
  time: TimeTool,
  light: LightTool,
  look: LookTool,
  fields: FieldsTool,
  probe: ProbeTool,
  marks: MarksTool,
};

// Tools that change the scene for all people. They are locked for viewers who do not steer.
const STEERED: readonly ToolName[] = ["time", "light", "look", "fields"];

export function ToolRail({ page }: { page: Page }) {
  const { state } = page;
  return (
    <nav class="rail" aria-label="Tools" data-testid="rail">
      {TOOL_NAMES.map((name) => (
        <button
          key={name}
          type="button"
          data-testid={`rail-${name}`}
          aria-expanded={state.tool.value === name}
          aria-controls="tool"
          title={`${TOOL_TEXTS[name].title} (${TOOL_TEXTS[name].key})`}
          onClick={() => page.toggleTool(name)}
        >
          <Icon name={name} />
          {TOOL_TEXTS[name].label}
        </button>
      ))}
      <button
        type="button"
        class="rail-extra"
        data-testid="rail-settings"
        aria-expanded={state.drawerOpen.value}
        aria-controls="drawer"
        title="Every setting (X)"
        onClick={() => page.toggleDrawer()}
      >
        <Icon name="settings" />
        All
      </button>
      <button
        type="button"
        class="rail-extra"
        data-testid="rail-help"
        aria-expanded={state.popover.value === "help"}
        aria-haspopup="dialog"
        title="Keys and gestures (?)"
        onClick={() => page.togglePopover("help")}
      >
        <Icon name="help" />
        Help
      </button>
    </nav>
  );
}

// Moves the focus to the button that opened a panel, after the panel was closed.
export function focusRail(name: ToolName | "settings"): void {
  document.querySelector<HTMLElement>(`[data-testid=rail-${name}]`)?.focus();
}

export function ToolPanel({ page }: { page: Page }) {
  const name = page.state.tool.value;
  if (name === undefined) return <aside id="tool" hidden />;
  return <OpenTool key={name} page={page} name={name} />;
}

function OpenTool({ page, name }: { page: Page; name: ToolName }) {
  const panel = useRef<HTMLElement>(null);
  const block = page.state.session.editBlock.value;
  const locked = block !== undefined && STEERED.includes(name);
  const Content = CONTENTS[name];
  const { title, key } = TOOL_TEXTS[name];
  // A layout effect is used because the focus must change before the next key is handled.
  useLayoutEffect(() => {
    if (page.state.toolTakesFocus) panel.current?.focus();
  }, [page]);
  return (
    <aside
      id="tool"
      ref={panel}
      class="tool-panel"
      aria-label={title}
      tabIndex={-1}
      data-testid="tool-panel"
      data-tool={name}
    >
      <header>
        <h2>{title}</h2>
        <span class="quiet" aria-hidden="true">
          key {key}
        </span>
        <button
          type="button"
          class="close"
          aria-label={`Close ${title}`}
          onClick={() => {
            page.toggleTool(name);
            focusRail(name);
          }}
        >
          ×
        </button>
      </header>
      {block !== undefined && (
        <p class="blocked" data-testid="edit-block">
          {block}
        </p>
      )}
      <fieldset class="controls" disabled={locked} data-testid="controls">
        <legend class="visually-hidden">{title}</legend>
        <Content page={page} />
      </fieldset>
    </aside>
  );
}
