// Decodes the pictures of one stream of video at a time, each of which needs those before it. Every picture is decoded, in the
// order in which it came, whether or not it will be shown.

// Profile 0, 8 bits; the level leaves room for any size that a server sends.
export const VP9 = "vp09.00.62.08";

// The colours are those of JPEG: sRGB as full-range BT.601.
export const VIDEO_CONFIG: VideoDecoderConfig = {
  codec: VP9,
  optimizeForLatency: true,
  colorSpace: {
    primaries: "bt709",
    transfer: "iec61966-2-1",
    matrix: "smpte170m",
    fullRange: true,
  },
};

interface Waiting {
  resolve(picture: VideoFrame): void;
  reject(reason: unknown): void;
}

export class VideoPictures {
  #decoder: VideoDecoder | undefined;
  #count = 0;
  // By timestamp, which only counts.
  #waiting = new Map<number, Waiting>();

  // The caller closes the picture. Rejects for a picture that needs one that was not decoded.
  decode(bytes: Uint8Array, isKey: boolean): Promise<VideoFrame> {
    return new Promise((resolve, reject) => {
      try {
        if (isKey) this.#decoder ??= this.#newDecoder();
        if (this.#decoder === undefined) throw new Error("the key picture is missing");
        const timestamp = this.#count;
        this.#count += 1;
        const type = isKey ? "key" : "delta";
        const chunk = new EncodedVideoChunk({ type, timestamp, data: bytes as BufferSource });
        this.#waiting.set(timestamp, { resolve, reject });
        this.#decoder.decode(chunk);
      } catch (reason) {
        this.reset();
        reject(reason);
      }
    });
  }

  // A picture was left out, or another stream begins: the next to be decoded is a key picture.
  reset(): void {
    const decoder = this.#decoder;
    this.#decoder = undefined;
    if (decoder !== undefined && decoder.state !== "closed") decoder.close();
    for (const { reject } of this.#waiting.values()) reject(new Error("the stream has ended"));
    this.#waiting.clear();
  }

  #newDecoder(): VideoDecoder {
    const decoder: VideoDecoder = new VideoDecoder({
      output: (picture) => {
        const waiting = this.#waiting.get(picture.timestamp);
        this.#waiting.delete(picture.timestamp);
        if (waiting === undefined) picture.close();
        else waiting.resolve(picture);
      },
      error: () => {
        if (this.#decoder === decoder) this.reset();
      },
    });
    decoder.configure(VIDEO_CONFIG);
    return decoder;
  }
}
