// Matches the scenes that were sent with the frames that were shown, by the scenes' revisions. One
// result is the latency, from sending a scene to showing a frame of that or a later scene. The
// other result is the index of the storm's time that the picture shows.

interface Sent {
  readonly sentAtMs: number;
  readonly timeIndex: number;
  revision: bigint | undefined;
}

// Maximum number of sent scenes that wait for their frame. Older scenes are dropped and give no
// latency.
const MAX_OPEN = 64;
const MAX_LATENCIES = 60;

export class RevisionLedger {
  #open: Sent[] = [];
  #recentlyShown: { revision: bigint; atMs: number }[] = [];
  #latenciesMs: number[] = [];
  #newestShown = -1n;
  #shownTimeIndex: number | undefined;

  // Returns the time index of the newest recorded revision that is finished, as settled() defines
  // it.
  get shownTimeIndex(): number | undefined {
    return this.#shownTimeIndex;
  }

  // Returns the median of the recent latencies.
  get latencyMs(): number | undefined {
    const sorted = [...this.#latenciesMs].sort((a, b) => a - b);
    return sorted[Math.floor(sorted.length / 2)];
  }

  get lastLatencyMs(): number | undefined {
    return this.#latenciesMs[this.#latenciesMs.length - 1];
  }

  // Forgets all revisions. A new session numbers its revisions from the start again.
  startSession(): void {
    this.#open = [];
    this.#recentlyShown = [];
    this.#newestShown = -1n;
    this.#shownTimeIndex = undefined;
  }

  // Records that a scene is sent. Returns the functions to call with the server's response.
  sent(timeIndex: number, nowMs: number): { accepted(revision: bigint): void; refused(): void } {
    const entry: Sent = { sentAtMs: nowMs, timeIndex, revision: undefined };
    this.#open.push(entry);
    if (this.#open.length > MAX_OPEN) this.#open.shift();
    return {
      accepted: (revision) => this.#accepted(entry, revision),
      refused: () => {
        this.#open = this.#open.filter((other) => other !== entry);
      },
    };
  }

  // Records a scene that another viewer has set. The scene counts for `shownTimeIndex` but not for
  // the latency.
  told(timeIndex: number, revision: bigint): void {
    this.#open.push({ sentAtMs: Number.POSITIVE_INFINITY, timeIndex, revision });
    if (this.#open.length > MAX_OPEN) this.#open.shift();
    this.#close();
  }

  // Records that a frame of this revision is on the screen.
  shown(revision: bigint, nowMs: number): void {
    this.#recentlyShown.push({ revision, atMs: nowMs });
    if (this.#recentlyShown.length > MAX_OPEN) this.#recentlyShown.shift();
    this.settled(revision);
  }

  // Records that this revision is finished: its frame was shown, or the server reported a problem
  // instead of a frame.
  settled(revision: bigint): void {
    if (revision > this.#newestShown) this.#newestShown = revision;
    this.#close();
  }

  #accepted(entry: Sent, revision: bigint): void {
    entry.revision = revision;
    this.#close();
  }

  // Removes the finished scenes from the waiting scenes. This is called for each new revision,
  // whether a response or a frame reports it, because a frame may arrive before the response that
  // names its revision.
  #close(): void {
    const stillOpen: Sent[] = [];
    for (const entry of this.#open) {
      if (entry.revision === undefined || entry.revision > this.#newestShown) {
        stillOpen.push(entry);
        continue;
      }
      this.#shownTimeIndex = entry.timeIndex;
      const { revision, sentAtMs } = entry;
      const frame = this.#recentlyShown.find((f) => f.revision >= revision && f.atMs >= sentAtMs);
      if (frame !== undefined) this.#keepLatency(frame.atMs - sentAtMs);
    }
    this.#open = stillOpen;
  }

  #keepLatency(latencyMs: number): void {
    this.#latenciesMs.push(latencyMs);
    if (this.#latenciesMs.length > MAX_LATENCIES) this.#latenciesMs.shift();
  }
}
