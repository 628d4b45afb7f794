// Loads parts of the page when they are first needed.
import type { PageState } from "../core/state";

// After an update of the server, the parts of an older page no longer exist.
export const couldNotBeLoaded = (what: string): string =>
  `${what} could not be loaded. Reload the page: the server may have been updated since it was opened`;

// Calls `use` with the part. Shows a notice if the part could not be loaded.
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
