// Calls for pictures that are kept: one with its progress, or a job of many.
import { type Client, Code, ConnectError, createClient, type Transport } from "@connectrpc/connect";
import {
  type RenderJob,
  RenderJobService,
  RenderJobPictureState_State as State,
} from "../gen/thunderhead/v1/job_pb";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import type { RenderImageResponse } from "../gen/thunderhead/v1/thunderhead_pb";
import { ImageFormat, ThunderheadService } from "../gen/thunderhead/v1/thunderhead_pb";

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

  // `progress` is the share of the light that is traced.
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
    throw new ConnectError("the server ended without a picture", Code.Internal);
  }

  // Pictures in the order of the scenes, drawn by a job that goes on if this page is closed; where the server keeps no jobs, one
  // after the other.
  async *pictures(
    scenes: readonly Scene[],
    label: string,
    signal: AbortSignal,
  ): AsyncGenerator<DrawnPicture> {
    const job = await this.#createJob(scenes, label, signal);
    if (job === undefined) {
      for (const scene of scenes)
        yield await this.picture(scene, ImageFormat.JPEG, signal, () => undefined);
      return;
    }
    try {
      yield* this.#results(job.id, scenes.length, signal);
    } finally {
      // Done or given up: nobody else fetches them.
      await this.#jobs.cancelRenderJob({ jobId: job.id, forget: true }).catch(() => undefined);
    }
  }

  async #createJob(
    scenes: readonly Scene[],
    label: string,
    signal: AbortSignal,
  ): Promise<RenderJob | undefined> {
    const pictures = scenes.map((scene) => ({ scene, format: ImageFormat.JPEG }));
    try {
      return (await this.#jobs.createRenderJob({ label, pictures }, { signal })).job;
    } catch (error) {
      const { code } = ConnectError.from(error);
      if (code === Code.FailedPrecondition || code === Code.Unimplemented) return undefined;
      throw error;
    }
  }

  async *#results(jobId: string, count: number, signal: AbortSignal): AsyncGenerator<DrawnPicture> {
    let next = 0;
    const drawn = new Set<number>();
    for await (const { pictures } of this.#jobs.watchRenderJob({ jobId }, { signal })) {
      for (const { index, state, problem } of pictures) {
        if (state === State.DRAWN) drawn.add(index);
        else if (state === State.FAILED || state === State.DROPPED)
          throw new ConnectError(`picture ${index + 1}: ${problem?.message ?? "it failed"}`);
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
    if (picture === undefined) throw new ConnectError("a picture came without its description");
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
