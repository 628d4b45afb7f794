// Parts of the page that are loaded when they are first needed.
import type { PageState } from "../core/state";

// Calls `use` with the part. If it cannot be had, says so: after an update of the server the parts of an older page are gone.
export function withPart<Part>(
  state: PageState,
  what: string,
  load: () => Promise<Part>,
  use: (part: Part) => unknown,
): void {
  load().then(use, () =>
    state.notify({
      subject: `part ${what}`,
      text: `${what} could not be loaded. Reload the page: the server may have been updated since it was opened`,
      severity: "problem",
    }),
  );
}
