// One viewer's way to the server: opens or joins a session, follows its frames, sends scenes and
// acknowledgements, and when the connection or the session is lost gets it back by itself. Knows neither
// widgets nor what a scene looks like.
import { type Client, Code, ConnectError, createClient, type Transport } from "@connectrpc/connect";
import { BackOff } from "../core/back_off";
import type { Connection } from "../core/state";
import type { GenerateCloudRequest } from "../gen/thunderhead/v1/cloud_pb";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import type { StormDescription, StormSummary } from "../gen/thunderhead/v1/storm_pb";
import {
  type Frame,
  type GetServerInfoResponse,
  type Problem,
  ThunderheadService,
} from "../gen/thunderhead/v1/thunderhead_pb";

export interface OpenedSession {
  readonly id: string;
  // The scene the session was asked to start with, the scene as the server completed it, and its revision.
  readonly asked: Scene;
  readonly completed: Scene;
  readonly revision: bigint;
  // True where it takes the place of a session that the server no longer has.
  readonly replaces: boolean;
}

export interface SessionListener {
  // The scene that a new session is to start with.
  sceneToOpen(): Scene;
  // The server will not open a session with that scene; another is asked for after a while.
  openingRefused(message: string): void;
  opened(session: OpenedSession): void;
  // A stream has begun; its frames are counted anew and the session takes scenes again.
  streaming(sessionId: string): void;
  connection(connection: Connection): void;
  // The session's whole scene at a revision, as it is or as somebody has just made it.
  scene(scene: Scene, revision: bigint): void;
  frame(frame: Frame): void;
  problem(problem: Problem): void;
}

export type SceneVerdict =
  | { readonly kind: "taken"; readonly revision: bigint }
  | { readonly kind: "refused"; readonly message: string };

const CALL_TIMEOUT_MS = 10_000;
// Where the camera is left open the server reads the storm before it answers, which may take a while.
const SCENE_TIMEOUT_MS = 120_000;
const CLOUD_TIMEOUT_MS = 120_000;
// A stream silent for this long is checked, so that a connection that died without a word is noticed.
export const SILENCE_MS = 5_000;
const CHECK_TIMEOUT_MS = 4_000;
// A stream that lived for this long was a success; one that breaks sooner makes the next wait longer.
const SOUND_MS = 2_000;

// What a network says that fails, and a server that fails says as well.
const NETWORK_CODES = new Set([
  Code.Unknown,
  Code.Unavailable,
  Code.Canceled,
  Code.DeadlineExceeded,
  Code.Internal,
]);

export class SessionClient {
  readonly #client: Client<typeof ThunderheadService>;
  readonly #listener: SessionListener;
  readonly #backOff = new BackOff();
  readonly #life = new AbortController();
  #sessionId: string | undefined;
  #hadSession: boolean;
  #reopened = false;
  #viewerId: bigint | undefined;
  #stream: AbortController | undefined;
  #retryNow: (() => void) | undefined;
  #retryInMs = 0;

  // Joins `sessionId` where it is given and still there, and opens a new session otherwise.
  constructor(transport: Transport, listener: SessionListener, sessionId?: string) {
    this.#client = createClient(ThunderheadService, transport);
    this.#listener = listener;
    this.#sessionId = sessionId;
    this.#hadSession = sessionId !== undefined;
  }

  // Runs until dispose().
  async run(): Promise<void> {
    while (!this.#life.signal.aborted) {
      try {
        this.#sessionId ??= await this.#open();
        await this.#watch(this.#sessionId);
        this.#lost("The server ended the stream");
      } catch (error) {
        if (this.#life.signal.aborted) return;
        if (this.#sessionId !== undefined && ConnectError.from(error).code === Code.NotFound) {
          // Ended on the server. A new one takes its place at once, but only once until a stream has begun.
          this.#sessionId = undefined;
          if (!this.#reopened) {
            this.#reopened = true;
            continue;
          }
        }
        this.#lost(reasonOf(error));
      }
      await this.#wait();
    }
  }

  // Tries again at once where it waits to.
  retryNow(): void {
    this.#retryNow?.();
  }

  // Rejects where the connection is lost; the scene must then be sent again after streaming().
  async updateScene(scene: Scene): Promise<SceneVerdict> {
    const stream = this.#stream;
    const first = await this.#sendScene(scene);
    if (first instanceof ConnectError === false) return first;
    // The network or the server: if the server still answers the scene gets a second chance, its last.
    if (stream !== undefined) await this.#check(stream);
    const second = stream?.signal.aborted ? first : await this.#sendScene(scene);
    if (second instanceof ConnectError === false) return second;
    if (stream === undefined || stream.signal.aborted) throw second;
    return { kind: "refused", message: second.rawMessage };
  }

  // The frame is on the screen.
  acknowledge(sequence: bigint): void {
    const sessionId = this.#sessionId;
    const viewerId = this.#viewerId;
    const signal = this.#stream?.signal;
    if (sessionId === undefined || viewerId === undefined || signal === undefined) return;
    this.#client
      .acknowledgeFrame({ sessionId, viewerId, sequence }, { signal, timeoutMs: CALL_TIMEOUT_MS })
      // Without acknowledgements the stream would stand still, so it is opened again.
      .catch((error: unknown) => {
        if (this.#viewerId === viewerId) this.#stream?.abort(ConnectError.from(error));
      });
  }

  serverInfo(): Promise<GetServerInfoResponse> {
    return this.#client.getServerInfo({}, this.#lifeOptions());
  }

  async storms(): Promise<readonly StormSummary[]> {
    return (await this.#client.listStorms({}, this.#lifeOptions())).storms;
  }

  async describeStorm(stormId: string, timeIndex: number): Promise<StormDescription | undefined> {
    return (await this.#client.describeStorm({ stormId, timeIndex }, this.#lifeOptions())).storm;
  }

  async generateCloud(
    request: GenerateCloudRequest,
    signal: AbortSignal,
  ): Promise<StormSummary | undefined> {
    const options = { signal, timeoutMs: CLOUD_TIMEOUT_MS };
    return (await this.#client.generateCloud(request, options)).storm;
  }

  async deleteCloud(stormId: string): Promise<void> {
    await this.#client.deleteCloud({ stormId }, { timeoutMs: CALL_TIMEOUT_MS });
  }

  // Tells the server that the session is no longer needed; for a page that goes away.
  closeSession(): void {
    const sessionId = this.#sessionId;
    if (sessionId === undefined) return;
    // Nobody is left to hear of a failure.
    this.#client.closeSession({ sessionId }, { timeoutMs: CALL_TIMEOUT_MS }).catch(() => undefined);
  }

  dispose(): void {
    this.#life.abort();
    this.#stream?.abort();
    this.#retryNow?.();
  }

  // The error where it says as little of the scene as a network's would.
  async #sendScene(scene: Scene): Promise<SceneVerdict | ConnectError> {
    const sessionId = this.#sessionId;
    if (sessionId === undefined) return new ConnectError("there is no session", Code.Unavailable);
    const signal = this.#stream?.signal ?? this.#life.signal;
    const options = { signal, timeoutMs: SCENE_TIMEOUT_MS };
    try {
      const response = await this.#client.updateScene({ sessionId, scene }, options);
      return { kind: "taken", revision: response.sceneRevision };
    } catch (error) {
      const failure = ConnectError.from(error);
      // A session that has ended closes its stream as well, which run() answers.
      if (NETWORK_CODES.has(failure.code)) return failure;
      return { kind: "refused", message: failure.rawMessage };
    }
  }

  async #open(): Promise<string> {
    const asked = this.#listener.sceneToOpen();
    try {
      const options = { signal: this.#life.signal, timeoutMs: SCENE_TIMEOUT_MS };
      const response = await this.#client.createSession({ scene: asked }, options);
      const { sessionId, scene, sceneRevision } = response;
      this.#listener.opened({
        id: sessionId,
        asked,
        completed: scene ?? asked,
        revision: sceneRevision,
        replaces: this.#hadSession,
      });
      this.#hadSession = true;
      return sessionId;
    } catch (error) {
      const failure = ConnectError.from(error);
      const full = failure.code === Code.ResourceExhausted;
      if (!full && !NETWORK_CODES.has(failure.code)) {
        this.#listener.openingRefused(failure.rawMessage);
      }
      throw failure;
    }
  }

  async #watch(sessionId: string): Promise<void> {
    const stream = new AbortController();
    this.#stream = stream;
    const silence = new SilenceWatch(() => this.#check(stream));
    const startedAtMs = performance.now();
    let begun = false;
    try {
      silence.heard();
      for await (const message of this.#client.watchFrames(
        { sessionId },
        { signal: stream.signal },
      )) {
        silence.heard();
        this.#viewerId = message.viewerId;
        if (!begun) {
          begun = true;
          this.#reopened = false;
          this.#listener.connection({ kind: "live" });
          this.#listener.streaming(sessionId);
        }
        if (message.scene !== undefined) {
          this.#listener.scene(message.scene, message.sceneRevision);
        }
        if (message.event.case === "frame") this.#listener.frame(message.event.value);
        if (message.event.case === "problem") this.#listener.problem(message.event.value);
      }
    } catch (error) {
      // The reason for which this page gave the stream up says more than that it was given up.
      throw stream.signal.aborted ? (stream.signal.reason ?? error) : error;
    } finally {
      silence.dispose();
      if (begun && performance.now() - startedAtMs > SOUND_MS) this.#backOff.reset();
      this.#viewerId = undefined;
      this.#stream = undefined;
    }
  }

  async #check(stream: AbortController): Promise<void> {
    try {
      await this.#client.getServerInfo({}, { timeoutMs: CHECK_TIMEOUT_MS, signal: stream.signal });
    } catch (error) {
      stream.abort(ConnectError.from(error));
    }
  }

  #lost(reason: string): void {
    if (this.#life.signal.aborted) return;
    const retryInMs = this.#backOff.next();
    this.#retryInMs = retryInMs;
    const attempts = this.#backOff.attempts;
    this.#listener.connection({ kind: "lost", reason, attempts, retryInMs });
  }

  async #wait(): Promise<void> {
    if (this.#life.signal.aborted) return;
    await new Promise<void>((resolve) => {
      const timer = setTimeout(resolve, this.#retryInMs);
      this.#retryNow = () => {
        clearTimeout(timer);
        resolve();
      };
    });
    this.#retryNow = undefined;
  }

  #lifeOptions(): { signal: AbortSignal; timeoutMs: number } {
    return { signal: this.#life.signal, timeoutMs: CALL_TIMEOUT_MS };
  }
}

// Calls back each time nothing was heard for SILENCE_MS.
class SilenceWatch {
  readonly #onSilence: () => Promise<void>;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #disposed = false;

  constructor(onSilence: () => Promise<void>) {
    this.#onSilence = onSilence;
  }

  heard(): void {
    clearTimeout(this.#timer);
    if (this.#disposed) return;
    this.#timer = setTimeout(() => void this.#onSilence().then(() => this.heard()), SILENCE_MS);
  }

  dispose(): void {
    this.#disposed = true;
    clearTimeout(this.#timer);
  }
}

// What the server said, where it said it; the network's own words help nobody.
function reasonOf(error: unknown): string {
  const failure = ConnectError.from(error);
  return NETWORK_CODES.has(failure.code) ? "The server cannot be reached" : failure.rawMessage;
}
