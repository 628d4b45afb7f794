// Tests the encodings that the page requests, and the readout's text if video is not among them.
import { afterEach, describe, expect, it, vi } from "vitest";
import { nameOfEncoding } from "../src/core/encoding";
import { Codec } from "../src/gen/thunderhead/v1/interact_pb";
import { learnDecodable } from "../src/view/decodable";

interface Browser {
  readonly secure?: boolean;
  // The result of VideoDecoder.isConfigSupported; undefined without WebCodecs.
  readonly vp9?: boolean | "throws";
  readonly avif?: boolean;
}

async function learnIn({ secure = true, vp9, avif = true }: Browser) {
  const isConfigSupported = async () => {
    if (vp9 === "throws") throw new TypeError("bad configuration");
    return { supported: vp9 };
  };
  vi.stubGlobal("VideoDecoder", vp9 === undefined ? undefined : { isConfigSupported });
  vi.stubGlobal("createImageBitmap", async () => {
    if (!avif) throw new Error("no AVIF");
    return { close: () => undefined };
  });
  return learnDecodable({ isSecureContext: secure });
}

describe("what a browser decodes", () => {
  afterEach(() => vi.unstubAllGlobals());

  it("is everything where it has WebCodecs and AVIF", async () => {
    const { codecs, whyNoVideo } = await learnIn({ vp9: true });
    expect(codecs).toEqual([Codec.JPEG, Codec.VP9, Codec.AVIF]);
    expect(whyNoVideo).toBeUndefined();
    expect(nameOfEncoding("vp9", whyNoVideo)).toBe("VP9 video");
    expect(nameOfEncoding("jpeg", whyNoVideo)).toBe("JPEG");
  });

  it.each([
    // Browsers hide WebCodecs without HTTPS, so a missing WebCodecs does not mean that the browser
    // is old.
    [{ secure: false }, "video needs HTTPS or localhost"],
    [{}, "this browser has no WebCodecs"],
    [{ vp9: false }, "this browser cannot decode VP9"],
    [{ vp9: "throws" }, "this browser cannot decode VP9"],
  ] as const)("is no video in %o, and the readout says why", async (browser, why) => {
    const { codecs, whyNoVideo } = await learnIn(browser);
    expect(codecs).toEqual([Codec.JPEG, Codec.AVIF]);
    expect(whyNoVideo).toBe(why);
    expect(nameOfEncoding("jpeg", whyNoVideo)).toBe(`JPEG; ${why}`);
    expect(nameOfEncoding("avif", whyNoVideo)).toBe(`AVIF, 10 bits; ${why}`);
  });

  it("is JPEG alone where it decodes nothing else", async () => {
    const { codecs } = await learnIn({ avif: false });
    expect(codecs).toEqual([Codec.JPEG]);
  });
});
