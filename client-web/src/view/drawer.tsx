// The drawer with every setting of the scene and a search box. Units, limits, defaults and
// explanations come from the Protobuf schema.
import type { ComponentType } from "preact";
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import type { SettingsProps } from "./every_setting";
import type { Page } from "./page";
import { withPart } from "./part";
import { focusRail } from "./tool_rail";

// The drawer. Its content is loaded when it first opens.
export function ExpertDrawer({ page }: { page: Page }) {
  const [Settings, setSettings] = useState<ComponentType<SettingsProps> | undefined>(undefined);
  const [query, setQuery] = useState("");
  const drawer = useRef<HTMLElement>(null);
  const search = useRef<HTMLInputElement>(null);
  const open = page.state.drawerOpen.value;
  const block = page.state.session.editBlock.value;
  const wasOpen = useRef(false);
  // A layout effect is used because the focus must change before the next key is handled.
  useLayoutEffect(() => {
    const closes = wasOpen.current && !open;
    wasOpen.current = open;
    // This finds out whether the focus was in the drawer. Browsers remove the focus from hidden
    // elements, but not at once.
    const focused = document.activeElement;
    if (closes && (focused === document.body || drawer.current?.contains(focused))) {
      focusRail("settings");
    }
    if (open) search.current?.focus();
  }, [open]);
  useEffect(() => {
    if (!open) return;
    withPart(
      page.state,
      "Every setting",
      () => import("./every_setting"),
      ({ EverySetting }) => setSettings(() => EverySetting),
    );
  }, [open, page]);
  return (
    <aside
      id="drawer"
      ref={drawer}
      class="drawer"
      aria-label="Every setting"
      data-testid="drawer"
      hidden={!open}
    >
      <header>
        <h2>Every setting</h2>
        <button
          type="button"
          class="close"
          aria-label="Close every setting"
          onClick={() => page.toggleDrawer()}
        >
          ×
        </button>
      </header>
      {open && (
        <>
          <div class="drawer-search">
            <input
              ref={search}
              type="search"
              aria-label="Search settings"
              placeholder="Search: haze, albedo, seed …"
              data-testid="drawer-search"
              value={query}
              onInput={(event) => setQuery(event.currentTarget.value)}
            />
          </div>
          {block !== undefined && <p class="blocked">{block}</p>}
          <fieldset class="controls" disabled={block !== undefined}>
            <legend class="visually-hidden">Every setting</legend>
            {Settings === undefined ? (
              <p class="quiet">Loading …</p>
            ) : (
              <Settings page={page} query={query} />
            )}
          </fieldset>
        </>
      )}
    </aside>
  );
}
