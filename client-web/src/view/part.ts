// Parts of the page that are loaded when they are first needed.
import type { PageState } from "../core/state";

// After an update of the server the parts of an older page are gone.
export const couldNotBeLoaded = (what: string): string =>
  `${what} could not be loaded. Reload the page: the server may have been updated since it was opened`;

// Calls `use` with the part. Says so if it cannot be had.
export function withPart<Part>(
  state: PageState,
  what: string,
  load: () => Promise<Part>,
  use: (part: Part) => unknown,
): void {
  load().then(use, () =>
    state.notify({
      subject: `part ${what}`,
      text: couldNotBeLoaded(what),
      severity: "problem",
    }),
  );
}
