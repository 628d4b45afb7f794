// The movie whose pictures a job of the server draws, remembered for this tab: after a reload the page goes on with it.
import type { MovieDraft } from "./movie_plan";
import type { TextStore } from "./own_keys";

export interface MovieWork {
  readonly jobId: string;
  readonly pictures: number;
  readonly draft: MovieDraft;
  // The storm that the pictures' texts are of.
  readonly stormId: string;
}

const MOVIE_ITEM = "thunderhead.movie";

export class RememberedMovie {
  readonly #store: TextStore | undefined;

  constructor(store: TextStore | undefined) {
    this.#store = store;
  }

  // False where the browser keeps nothing: a reload loses the movie.
  remember(work: MovieWork): boolean {
    return this.#set(JSON.stringify(work));
  }

  forget(): void {
    this.#set("");
  }

  get work(): MovieWork | undefined {
    try {
      const work: unknown = JSON.parse(this.#store?.getItem(MOVIE_ITEM) || "null");
      return isWork(work) ? work : undefined;
    } catch {
      return undefined;
    }
  }

  #set(text: string): boolean {
    try {
      this.#store?.setItem(MOVIE_ITEM, text);
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
