// Decodes the frames of one video stream at a time. Each frame depends on those before it. Every
// frame is therefore decoded in order of arrival, whether or not it will be shown.

// The codec string for VP9 profile 0, level 6.2, 8 bits. This level is sufficient for any size that
// a server sends.
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
  // The frames that are being decoded, by their timestamps. The timestamps are only counters.
  #waiting = new Map<number, Waiting>();

  // Decodes a frame. The caller must close the result. Rejects if the frame cannot be decoded, for
  // example because it depends on a frame that was not decoded.
  decode(bytes: Uint8Array, isKey: boolean): Promise<VideoFrame> {
    return new Promise((resolve, reject) => {
      try {
        if (isKey) this.#decoder ??= this.#newDecoder();
        if (this.#decoder === undefined) throw new Error("the key frame is missing");
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

  // Resets the decoder because a frame was skipped or another stream begins. The next frame to
  // decode must be a key frame.
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
