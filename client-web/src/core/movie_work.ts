// A list of the movies whose pictures are drawn by jobs on the server, at most one movie for each
// storm. The browser keeps the list for this tab. After a reload the page continues the movie of
// the storm that it shows.

import type { TextStore } from "./kept_text";
import type { MovieDraft } from "./movie_plan";

export interface MovieWork {
  readonly jobId: string;
  readonly pictures: number;
  readonly draft: MovieDraft;
  // The storm that the texts in the pictures describe.
  readonly stormId: string;
}

const itemOf = (stormId: string) => `thunderhead.movie.${stormId}`;

export class RememberedMovies {
  readonly #store: TextStore | undefined;

  constructor(store: TextStore | undefined) {
    this.#store = store;
  }

  // Remembers the movie. Returns false if the browser's storage is full or denied, in which case a
  // reload loses the movie.
  remember(work: MovieWork): boolean {
    return this.#set(work.stormId, JSON.stringify(work));
  }

  forget(stormId: string): void {
    this.#set(stormId, "");
  }

  of(stormId: string): MovieWork | undefined {
    try {
      const work: unknown = JSON.parse(this.#store?.getItem(itemOf(stormId)) || "null");
      return isWork(work) ? work : undefined;
    } catch {
      return undefined;
    }
  }

  #set(stormId: string, text: string): boolean {
    try {
      this.#store?.setItem(itemOf(stormId), text);
      return this.#store !== undefined;
    } catch {
      return false;
    }
  }
}

function isWork(value: unknown): value is MovieWork {
  const { jobId, pictures, draft, stormId } = (value ?? {}) as Record<string, unknown>;
  return (
    typeof jobId === "string" &&
    typeof pictures === "number" &&
    typeof stormId === "string" &&
    typeof draft === "object" &&
    draft !== null
  );
}
