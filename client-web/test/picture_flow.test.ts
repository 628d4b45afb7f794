// Tests of frames of two views. The requested view is painted, and every frame is acknowledged.
import { create } from "@bufbuild/protobuf";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { FrameSchema } from "../src/gen/thunderhead/v1/frame_pb";
import { PictureFlow } from "../src/view/picture_flow";
import { FakeCanvas, stubGlobals } from "./fake_window";

// Replaces the browser's decoder by one that outputs each frame at once. fail() makes it fail.
function stubVideo() {
  const types: string[] = [];
  const decoders: FakeDecoder[] = [];
  let open = 0;
  class FakeDecoder {
    state = "configured";
    readonly #init: VideoDecoderInit;
    constructor(init: VideoDecoderInit) {
      this.#init = init;
      decoders.push(this);
    }
    configure(): void {}
    decode(chunk: { type: string; timestamp: number }): void {
      types.push(chunk.type);
      open += 1;
      const close = () => {
        open -= 1;
      };
      const picture = { timestamp: chunk.timestamp, displayWidth: 640, displayHeight: 360, close };
      this.#init.output(picture as never);
    }
    close(): void {
      this.state = "closed";
    }
    fail(): void {
      this.state = "closed";
      this.#init.error(new DOMException("broken"));
    }
  }
  vi.stubGlobal("VideoDecoder", FakeDecoder);
  vi.stubGlobal(
    "EncodedVideoChunk",
    class {
      constructor(init: object) {
        Object.assign(this, init);
      }
    },
  );
  return { types, open: () => open, fail: () => decoders.at(-1)?.fail() };
}

describe("frames of the session's and the own view", () => {
  beforeEach(() => stubGlobals());
  afterEach(() => vi.unstubAllGlobals());

  function bench() {
    const log = { painted: [] as string[], acknowledged: [] as string[], wantsOwn: false };
    const paints: (() => void)[] = [];
    const name = (sequence: bigint, ownView: boolean) =>
      `${ownView ? "own" : "shared"} ${sequence}`;
    const flow = new PictureFlow({
      acknowledge: (sequence, ownView, videoLost) =>
        log.acknowledged.push(name(sequence, ownView) + (videoLost ? " lost" : "")),
      wantsOwnView: () => log.wantsOwn,
      painted: (frame) => log.painted.push(name(frame.sequence, frame.ownView)),
      undecodable: () => undefined,
      onNextPaint: (callback) => {
        paints.push(callback);
        return () => paints.splice(paints.indexOf(callback), 1);
      },
    });
    flow.attach(new FakeCanvas() as never);
    return {
      flow,
      log,
      offer: (sequence: bigint, ownView: boolean) =>
        flow.offer(create(FrameSchema, { sequence, ownView })),
      offerVideo: (sequence: bigint, keyFrame: boolean) =>
        flow.offer(create(FrameSchema, { sequence, keyFrame, vp9: new Uint8Array([1]) })),
      paint: async () => {
        await new Promise((resolve) => setTimeout(resolve, 0));
        for (const callback of paints.splice(0)) callback();
      },
    };
  }

  it("are acknowledged when they are painted", async () => {
    const { log, offer, paint } = bench();
    offer(7n, false);
    expect(log.acknowledged).toEqual([]);
    await paint();
    expect(log).toMatchObject({ painted: ["shared 7"], acknowledged: ["shared 7"] });
  });

  it("are acknowledged although another view has begun before they were painted", async () => {
    const { log, offer, paint } = bench();
    offer(7n, false);
    offer(8n, false);
    log.wantsOwn = true;
    offer(1n, true);
    await paint();
    expect(log.painted).toEqual(["own 1"]);
    expect(log.acknowledged).toEqual(["shared 8", "own 1"]);
  });

  it("are acknowledged unseen where the other view is wanted", async () => {
    const { log, offer, paint } = bench();
    log.wantsOwn = true;
    offer(1n, true);
    await paint();
    log.wantsOwn = false;
    offer(2n, true);
    await paint();
    expect(log).toMatchObject({ painted: ["own 1"], acknowledged: ["own 1", "own 2"] });
  });

  it("of video are all decoded, in order, though only the newest is painted", async () => {
    const decoded = stubVideo();
    const { log, offerVideo, paint } = bench();
    offerVideo(1n, true);
    offerVideo(2n, false);
    offerVideo(3n, false);
    await paint();
    await paint();
    expect(decoded.types).toEqual(["key", "delta", "delta"]);
    expect(log.painted.at(-1)).toBe("shared 3");
    expect(log.acknowledged.at(-1)).toBe("shared 3");
    expect(decoded.open()).toBeLessThanOrEqual(1);
  });

  it("of video that need a missing one are acknowledged as lost until a key picture", async () => {
    const decoded = stubVideo();
    const { log, offerVideo, paint } = bench();
    offerVideo(5n, false);
    await paint();
    expect(log).toMatchObject({ painted: [], acknowledged: ["shared 5 lost"] });
    offerVideo(6n, true);
    await paint();
    expect(log.painted).toEqual(["shared 6"]);
    decoded.fail();
    offerVideo(7n, false);
    await paint();
    expect(log.acknowledged.at(-1)).toBe("shared 7 lost");
  });

  it("are painted after all if that view is wanted soon after", async () => {
    const { flow, log, offer, paint } = bench();
    log.wantsOwn = true;
    offer(1n, true);
    await paint();
    offer(9n, false);
    log.wantsOwn = false;
    flow.viewChanged();
    await paint();
    expect(log.painted).toEqual(["own 1", "shared 9"]);
  });
});
