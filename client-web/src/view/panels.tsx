// The open panel of the top bar.
import { Compare } from "./compare/compare_panel";
import { Keep } from "./keep/keep_panel";
import { KEYS } from "./keyboard";
import type { Page } from "./page";
import { PeopleList } from "./people";
import { Popover } from "./popover";
import { Share } from "./share";
import { Storms } from "./storms";

export function Panels({ page }: { page: Page }) {
  switch (page.state.popover.value) {
    case "storms":
      return <Storms page={page} />;
    case "share":
      return <Share page={page} />;
    case "people":
      return <PeopleList page={page} />;
    case "compare":
      return <Compare page={page} />;
    case "keep":
      return <Keep page={page} />;
    case "help":
      return <Help page={page} />;
    default:
      return null;
  }
}

function Help({ page }: { page: Page }) {
  return (
    <Popover page={page} name="help" title="Mouse, touch and keys" label="Mouse, touch and keys">
      <dl class="keys">
        {KEYS.map(([key, what]) => (
          <div key={key}>
            <dt>{key}</dt>
            <dd>{what}</dd>
          </div>
        ))}
      </dl>
    </Popover>
  );
}
