// Fetches the map of the storm from above, which the server computes. The map is fetched only while
// a tool that shows it is open. It is fetched again when another storm or time is shown, and when
// the list of storms changes.
import { ConnectError } from "@connectrpc/connect";
import { effect } from "@preact/signals-core";
import type { PageState } from "../core/state";
import type { StormSummary } from "../gen/thunderhead/v1/storm_pb";
import type { ServerCalls } from "../transport/server_calls";

const REST_MS = 300;

interface Asked {
  readonly stormId: string;
  readonly timeIndex: number;
  readonly storms: readonly StormSummary[];
}

export class StormMap {
  readonly #calls: ServerCalls;
  readonly #state: PageState;
  readonly #stop: () => void;
  #timer: ReturnType<typeof setTimeout> | undefined;
  // The newest request. Answers to older requests are ignored.
  #asked: Asked | undefined;

  constructor(calls: ServerCalls, state: PageState) {
    this.#calls = calls;
    this.#state = state;
    this.#stop = effect(() => {
      const wanted = state.tool.value === "map" || state.tool.value === "probe";
      const live = state.connection.value.kind === "live";
      const stormId = state.stormId.value;
      const timeIndex = state.timeIndex.value;
      // Reading this signal fetches the map again when a file was replaced or deleted.
      const storms = state.storms.value;
      clearTimeout(this.#timer);
      if (!wanted || !live || stormId === "") return;
      if (state.stormMap.peek()?.stormId !== stormId) state.stormMap.value = undefined;
      this.#timer = setTimeout(() => void this.#fetch(stormId, timeIndex, storms), REST_MS);
    });
  }

  dispose(): void {
    this.#stop();
    clearTimeout(this.#timer);
  }

  async #fetch(stormId: string, timeIndex: number, storms: readonly StormSummary[]): Promise<void> {
    const last = this.#asked;
    const known =
      last?.stormId === stormId && last.timeIndex === timeIndex && last.storms === storms;
    if (known && this.#state.stormMap.peek() !== undefined) return;
    const asked = { stormId, timeIndex, storms };
    this.#asked = asked;
    try {
      const map = await this.#calls.stormMap(stormId, timeIndex);
      if (this.#asked !== asked) return;
      this.#state.stormMap.value = map;
      this.#state.mapProblem.value = undefined;
    } catch (error) {
      if (this.#asked !== asked) return;
      this.#asked = undefined;
      // The old map is removed, because it belongs to another time or storm.
      this.#state.stormMap.value = undefined;
      const why = error instanceof ConnectError ? error.rawMessage : String(error);
      this.#state.mapProblem.value = `The server could not send the map: ${why}`;
    }
  }
}
