// The server's storms, and generated clouds.
import { useState } from "preact/hooks";
import { CloudSection } from "./cloud_section";
import { Choice } from "./controls";
import type { Page } from "./page";
import { Popover } from "./popover";

export function Storms({ page }: { page: Page }) {
  const { state } = page;
  const storms = state.storms.value;
  const shown = storms.find((storm) => storm.id === state.stormId.value);
  const block = state.session.editBlock.value;
  return (
    <Popover page={page} name="storms" title="Storms" label="Storms on this server">
      {block !== undefined && <p class="blocked">{block}</p>}
      <fieldset class="controls" disabled={block !== undefined}>
        <legend class="visually-hidden">Storms</legend>
        <Choice
          label="Storm"
          testId="storm"
          value={state.stormId.value}
          options={storms.map((storm) => [storm.id, storm.title || storm.id] as const)}
          onChange={(id) => page.showStorm(id)}
        />
        {shown?.deletable && <DeleteCloud key={shown.id} page={page} />}
        <CloudSection page={page} />
      </fieldset>
      <button
        type="button"
        class="narrow-only"
        data-testid="storms-compare"
        onClick={() => page.togglePopover("compare")}
      >
        Compare with another storm, run or time
      </button>
      <button
        type="button"
        class="narrow-only"
        data-testid="storms-help"
        onClick={() => page.togglePopover("help")}
      >
        Touch and keys
      </button>
    </Popover>
  );
}

// The button that deletes a cloud. The first click asks for confirmation.
function DeleteCloud({ page }: { page: Page }) {
  const [asked, setAsked] = useState(false);
  return (
    <button
      type="button"
      data-testid="delete-cloud"
      onBlur={() => setAsked(false)}
      onClick={() => (asked ? void page.deleteCloud() : setAsked(true))}
    >
      {asked ? "Delete it for all viewers?" : "Delete this cloud"}
    </button>
  );
}
