// Which revision of the scene was sent when, and what the frames shown say about it: the latency from sending
// a revision to showing a frame of it or a later one, and which of the storm's times is on the screen.

interface Sent {
  readonly sentAtMs: number;
  readonly timeIndex: number;
  revision: bigint | undefined;
}

// Revisions that may await their frame at a time; older ones are forgotten without a latency.
const MOST_OPEN = 64;
const MOST_LATENCIES = 60;

export class RevisionLedger {
  #open: Sent[] = [];
  #recentlyShown: { revision: bigint; atMs: number }[] = [];
  #latenciesMs: number[] = [];
  #newestShown = -1n;
  #newestAccepted = -1n;
  #shownTimeIndex: number | undefined;

  // The time of the newest revision of ours that the screen shows.
  get shownTimeIndex(): number | undefined {
    return this.#shownTimeIndex;
  }

  // The newest revision that the server gave one of our scenes; -1 before the first.
  get newestAccepted(): bigint {
    return this.#newestAccepted;
  }

  // The median of recent latencies.
  get latencyMs(): number | undefined {
    const sorted = [...this.#latenciesMs].sort((a, b) => a - b);
    return sorted[Math.floor(sorted.length / 2)];
  }

  get lastLatencyMs(): number | undefined {
    return this.#latenciesMs[this.#latenciesMs.length - 1];
  }

  // Another session counts its revisions anew.
  startSession(): void {
    this.#open = [];
    this.#recentlyShown = [];
    this.#newestShown = -1n;
    this.#newestAccepted = -1n;
    this.#shownTimeIndex = undefined;
  }

  // A scene leaves; returns what tells its fate.
  sent(timeIndex: number, nowMs: number): { accepted(revision: bigint): void; refused(): void } {
    const entry: Sent = { sentAtMs: nowMs, timeIndex, revision: undefined };
    this.#open.push(entry);
    if (this.#open.length > MOST_OPEN) this.#open.shift();
    return {
      accepted: (revision) => this.#accepted(entry, revision),
      refused: () => {
        this.#open = this.#open.filter((other) => other !== entry);
      },
    };
  }

  // A frame of this revision is on the screen.
  shown(revision: bigint, nowMs: number): void {
    this.#recentlyShown.push({ revision, atMs: nowMs });
    if (this.#recentlyShown.length > MOST_OPEN) this.#recentlyShown.shift();
    this.settled(revision);
  }

  // This revision has all that it will get: a frame, or a problem in place of one.
  settled(revision: bigint): void {
    if (revision > this.#newestShown) this.#newestShown = revision;
    this.#close();
  }

  #accepted(entry: Sent, revision: bigint): void {
    entry.revision = revision;
    if (revision > this.#newestAccepted) this.#newestAccepted = revision;
    this.#close();
  }

  // A frame may come before the reply that names its revision, so both ends look for pairs.
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
    if (this.#latenciesMs.length > MOST_LATENCIES) this.#latenciesMs.shift();
  }
}
