// The calls for pictures that are saved: one picture with its progress, or a job that draws many
// pictures.
import { type Client, Code, ConnectError, createClient, type Transport } from "@connectrpc/connect";
import { BackOff } from "../core/back_off";
import {
  RenderJobService,
  RenderJobPictureState_State as State,
} from "../gen/thunderhead/v1/job_pb";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import type { RenderImageResponse } from "../gen/thunderhead/v1/thunderhead_pb";
import { ImageFormat, ThunderheadService } from "../gen/thunderhead/v1/thunderhead_pb";
import { NETWORK_CODES } from "./network_codes";
import { retryAfterMs } from "./retry_info";

// Maximum number of attempts without a new picture. With the back-off's delays these attempts take
// some minutes.
const MAX_ATTEMPTS = 60;

export interface DrawnPicture {
  readonly bytes: Uint8Array<ArrayBuffer>;
  readonly drawn: RenderImageResponse;
}

export class RenderCalls {
  readonly #service: Client<typeof ThunderheadService>;
  readonly #jobs: Client<typeof RenderJobService>;

  constructor(transport: Transport) {
    this.#service = createClient(ThunderheadService, transport);
    this.#jobs = createClient(RenderJobService, transport);
  }

  // Requests one picture. `progress` is called with the fraction of the light paths that the server
  // has traced, from 0 to 1.
  async picture(
    scene: Scene,
    format: ImageFormat,
    signal: AbortSignal,
    progress: (share: number) => void,
  ): Promise<DrawnPicture> {
    const chunks: Uint8Array[] = [];
    const request = { scene, format, inChunks: true };
    for await (const { event } of this.#service.renderImageWithProgress(request, { signal })) {
      if (event.case === "progress") progress(event.value.share);
      else if (event.case === "chunk") chunks.push(event.value);
      else if (event.case === "image") {
        if (event.value.image.length > 0) chunks.push(event.value.image);
        return { bytes: whole(chunks), drawn: event.value };
      }
    }
    throw new ConnectError("the server ended the call without sending a picture", Code.Internal);
  }

  // Requests the scenes' pictures in order, one after another.
  async *pictures(scenes: readonly Scene[], signal: AbortSignal): AsyncGenerator<DrawnPicture> {
    for (const scene of scenes)
      yield await this.picture(scene, ImageFormat.JPEG, signal, () => undefined);
  }

  // Begins a job that draws the scenes and continues if this page is closed. Returns the job's id;
  // undefined if the server keeps no jobs.
  async beginJob(
    scenes: readonly Scene[],
    label: string,
    signal: AbortSignal,
  ): Promise<string | undefined> {
    const pictures = scenes.map((scene) => ({ scene, format: ImageFormat.JPEG }));
    try {
      return (await this.#jobs.createRenderJob({ label, pictures }, { signal })).job?.id;
    } catch (error) {
      const { code } = ConnectError.from(error);
      if (code === Code.FailedPrecondition || code === Code.Unimplemented) return undefined;
      throw error;
    }
  }

  // Returns the job's pictures in order. A lost connection only delays them. Throws a ConnectError
  // if a picture fails, or after MAX_ATTEMPTS attempts without a new picture.
  async *picturesOfJob(
    jobId: string,
    count: number,
    signal: AbortSignal,
    backOff = new BackOff(),
  ): AsyncGenerator<DrawnPicture> {
    let next = 0;
    while (next < count) {
      try {
        for await (const picture of this.#results(jobId, next, count, signal)) {
          yield picture;
          next += 1;
          backOff.reset();
        }
      } catch (error) {
        const lost = error instanceof ConnectError && NETWORK_CODES.has(error.code);
        if (signal.aborted || !lost || backOff.attempts === MAX_ATTEMPTS) throw error;
        await pause(backOff.next(retryAfterMs(error)), signal);
      }
    }
  }

  // Cancels the job if it is still running, and deletes its pictures.
  async forgetJob(jobId: string): Promise<void> {
    await this.#jobs.cancelRenderJob({ jobId, forget: true }).catch(() => undefined);
  }

  async *#results(
    jobId: string,
    first: number,
    count: number,
    signal: AbortSignal,
  ): AsyncGenerator<DrawnPicture> {
    let next = first;
    const drawn = new Set<number>();
    for await (const { pictures } of this.#jobs.watchRenderJob({ jobId }, { signal })) {
      for (const { index, state, problem } of pictures) {
        if (state === State.DRAWN) drawn.add(index);
        else if (state === State.FAILED || state === State.DROPPED)
          throw new ConnectError(
            `picture ${index + 1}: ${problem?.message ?? "it failed"}`,
            Code.FailedPrecondition,
          );
      }
      while (drawn.has(next)) {
        yield await this.#result(jobId, next, signal);
        next += 1;
      }
      if (next === count) return;
    }
    throw new ConnectError("the job ended early", Code.Aborted);
  }

  async #result(jobId: string, index: number, signal: AbortSignal): Promise<DrawnPicture> {
    const chunks: Uint8Array[] = [];
    let picture: RenderImageResponse | undefined;
    for await (const part of this.#jobs.fetchRenderResult({ jobId, index }, { signal })) {
      picture ??= part.picture;
      chunks.push(part.chunk);
    }
    if (picture === undefined)
      throw new ConnectError("the server sent a picture without its description");
    return { bytes: whole(chunks), drawn: picture };
  }
}

function whole(chunks: readonly Uint8Array[]): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(chunks.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const chunk of chunks) {
    bytes.set(chunk, at);
    at += chunk.length;
  }
  return bytes;
}

function pause(delayMs: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(resolve, delayMs);
    signal.addEventListener("abort", () => {
      clearTimeout(timer);
      reject(signal.reason);
    });
  });
}
