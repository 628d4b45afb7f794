import { describe, expect, it } from "vitest";
import { FramePipeline } from "../src/core/frame_pipeline";
import { FrameRate } from "../src/core/frame_rate";
import { RevisionLedger } from "../src/core/revision_ledger";

interface Sequenced {
  readonly sequence: bigint;
}

// Makes a pipeline. The test controls its decoder and its screen refresh.
function bench() {
  const decoding: { frame: Sequenced; done(): void; fail(): void }[] = [];
  const paints: (() => void)[] = [];
  const log = { painted: [] as bigint[], released: [] as bigint[], failed: [] as bigint[] };
  const pipeline = new FramePipeline<Sequenced, bigint>({
    decode: (frame) =>
      new Promise((resolve, reject) => {
        decoding.push({
          frame,
          done: () => resolve(frame.sequence),
          fail: () => reject(new Error("bad")),
        });
      }),
    onNextPaint: (callback) => {
      paints.push(callback);
      return () => paints.splice(paints.indexOf(callback), 1);
    },
    paint: (_, picture) => log.painted.push(picture),
    release: (picture) => log.released.push(picture),
    failed: (frame) => log.failed.push(frame.sequence),
  });
  const settle = () => new Promise<void>((resolve) => setTimeout(resolve, 0));
  return {
    pipeline,
    decoding,
    log,
    offer: (...sequences: bigint[]) => {
      for (const sequence of sequences) pipeline.offer({ sequence });
    },
    decoded: async () => {
      decoding.shift()?.done();
      await settle();
    },
    undecodable: async () => {
      decoding.shift()?.fail();
      await settle();
    },
    refresh: () => {
      for (const paint of paints.splice(0)) paint();
    },
  };
}

describe("frames on their way to the screen", () => {
  it("come in order when there is time", async () => {
    const b = bench();
    for (const sequence of [1n, 2n, 3n]) {
      b.offer(sequence);
      await b.decoded();
      b.refresh();
    }
    expect(b.log.painted).toEqual([1n, 2n, 3n]);
    expect(b.pipeline.dropped).toBe(0);
  });

  it("leave out all but the newest while one is being decoded", async () => {
    const b = bench();
    b.offer(1n, 2n, 3n, 4n);
    expect(b.decoding.map(({ frame }) => frame.sequence)).toEqual([1n]);
    await b.decoded();
    expect(b.decoding.map(({ frame }) => frame.sequence)).toEqual([4n]);
    await b.decoded();
    b.refresh();
    expect(b.log.painted).toEqual([4n]);
    expect(b.log.released).toEqual([1n]);
    expect(b.pipeline.dropped).toBe(3);
  });

  it("are shown again when they come again, and when another view counts from the beginning", async () => {
    const b = bench();
    b.offer(5n);
    await b.decoded();
    b.refresh();
    b.offer(5n);
    await b.decoded();
    b.refresh();
    b.offer(1n);
    await b.decoded();
    b.refresh();
    expect(b.log.painted).toEqual([5n, 5n, 1n]);
  });

  it("go on after one that cannot be decoded", async () => {
    const b = bench();
    b.offer(1n, 2n);
    await b.undecodable();
    await b.decoded();
    b.refresh();
    expect(b.log.failed).toEqual([1n]);
    expect(b.log.painted).toEqual([2n]);
  });

  it("of an old stream are released, not painted; those of the new count anew", async () => {
    const b = bench();
    b.offer(100n);
    await b.decoded();
    b.offer(101n);
    b.pipeline.startStream();
    b.offer(1n);
    await b.decoded();
    await b.decoded();
    b.refresh();
    expect(b.log.painted).toEqual([1n]);
    expect(b.log.released.sort()).toEqual([100n, 101n]);
  });

  it("are all released once the page is done with them", async () => {
    const b = bench();
    b.offer(1n);
    await b.decoded();
    b.offer(2n);
    b.pipeline.dispose();
    await b.decoded();
    b.offer(3n);
    b.refresh();
    expect(b.log.painted).toEqual([]);
    expect(b.log.released.sort()).toEqual([1n, 2n]);
  });
});

describe("latency", () => {
  it("runs from sending a revision to showing it or a later one", () => {
    const ledger = new RevisionLedger();
    ledger.sent(0, 100).accepted(7n);
    ledger.sent(0, 150).accepted(8n);
    ledger.shown(6n, 160);
    expect(ledger.lastLatencyMs).toBeUndefined();
    ledger.shown(8n, 190);
    expect(ledger.lastLatencyMs).toBe(40);
    expect(ledger.latencyMs).toBe(90);
  });

  it("is right when the frame comes before the reply that names its revision", () => {
    const ledger = new RevisionLedger();
    const entry = ledger.sent(3, 100);
    ledger.shown(9n, 130);
    entry.accepted(9n);
    expect(ledger.lastLatencyMs).toBe(30);
    expect(ledger.shownTimeIndex).toBe(3);
  });

  it("counts no frame shown before the scene was sent", () => {
    const ledger = new RevisionLedger();
    ledger.shown(9n, 50);
    const entry = ledger.sent(0, 100);
    entry.accepted(9n);
    expect(ledger.lastLatencyMs).toBeUndefined();
  });

  it("forgets refused scenes and other sessions", () => {
    const ledger = new RevisionLedger();
    ledger.sent(1, 0).refused();
    ledger.sent(2, 0).accepted(5n);
    ledger.startSession();
    ledger.shown(5n, 10);
    expect(ledger.latencyMs).toBeUndefined();
    expect(ledger.shownTimeIndex).toBeUndefined();
  });

  it("holds a bounded number of scenes that nobody answers", () => {
    const ledger = new RevisionLedger();
    const first = ledger.sent(1, 0);
    for (let i = 0; i < 1000; i += 1) ledger.sent(2, i);
    first.accepted(1n);
    ledger.shown(1n, 5000);
    expect(ledger.shownTimeIndex).toBeUndefined();
  });

  it("takes a problem in place of a frame as the end of waiting, without a latency", () => {
    const ledger = new RevisionLedger();
    ledger.sent(2, 0).accepted(5n);
    ledger.settled(5n);
    expect(ledger.shownTimeIndex).toBe(2);
    expect(ledger.latencyMs).toBeUndefined();
  });
});

describe("the frame rate", () => {
  it("counts frames and bytes of the last two seconds", () => {
    const rate = new FrameRate();
    for (let at = 0; at < 4000; at += 100) rate.shown(1000, at);
    expect(rate.framesPerSecond(3900)).toBeCloseTo(10, 9);
    expect(rate.bytesPerSecond(3900)).toBeCloseTo(10_000, 6);
    expect(rate.framesPerSecond(6000)).toBe(0);
  });
});
