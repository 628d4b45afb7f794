// One viewer's connection to the server: opens or joins a session, receives its frames, sends scenes and
// acknowledgements, and reconnects by itself when the connection or the session is lost. Independent of widgets and
// of a scene's contents.
import { type Client, Code, ConnectError, createClient, type Transport } from "@connectrpc/connect";
import { BackOff } from "../core/back_off";
import type { Connection } from "../core/state";
import type { GenerateCloudRequest } from "../gen/thunderhead/v1/cloud_pb";
import type { Frame, Problem } from "../gen/thunderhead/v1/frame_pb";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import type { StormDescription, StormSummary } from "../gen/thunderhead/v1/storm_pb";
import {
  type GetServerInfoResponse,
  ThunderheadService,
} from "../gen/thunderhead/v1/thunderhead_pb";

export interface OpenedSession {
  readonly id: string;
  // The scene that was sent, the same scene with the server's defaults filled in, and its revision.
  readonly asked: Scene;
  readonly completed: Scene;
  readonly revision: bigint;
  // True if it replaces a session that the server no longer has.
  readonly replaces: boolean;
}

export interface SessionListener {
  // The scene that a new session is to start with.
  sceneToOpen(): Scene;
  // The server refuses to open a session with that scene; sceneToOpen() is called again after a delay.
  openingRefused(message: string): void;
  opened(session: OpenedSession): void;
  // A new stream of frames: sequence numbers restart, and the session accepts scenes again.
  streaming(sessionId: string): void;
  connection(connection: Connection): void;
  // The session's whole scene at a revision: at the start of a stream, and after any viewer changed it.
  scene(scene: Scene, revision: bigint): void;
  frame(frame: Frame): void;
  problem(problem: Problem): void;
}

export type SceneVerdict =
  | { readonly kind: "taken"; readonly revision: bigint }
  | { readonly kind: "refused"; readonly message: string };

const CALL_TIMEOUT_MS = 10_000;
// The server must read the storm before it can place a camera that the scene leaves open.
const SCENE_TIMEOUT_MS = 120_000;
const CLOUD_TIMEOUT_MS = 120_000;
// After this long without a message the connection is checked: it may have been lost without an error.
export const SILENCE_MS = 5_000;
const CHECK_TIMEOUT_MS = 4_000;
// A stream that lasted this long resets the back-off; one that breaks sooner lengthens the next wait.
const SOUND_MS = 2_000;

// Codes of network failures; some servers' failures have the same ones.
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

  // Joins `sessionId` if it is given and still exists, else opens a new session.
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
          // The session ended on the server. Open a new one at once, but only once until a stream begins.
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

  // Ends the wait before the next attempt, if there is one.
  retryNow(): void {
    this.#retryNow?.();
  }

  // Rejects if the connection is lost; the caller must send the scene again after streaming().
  async updateScene(scene: Scene): Promise<SceneVerdict> {
    const stream = this.#stream;
    const first = await this.#sendScene(scene);
    if (first instanceof ConnectError === false) return first;
    // It may be the network or the server. If the server still answers, the scene is sent a second and last time.
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
      // Without acknowledgements the server sends no more frames, so the stream is reopened.
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

  // Ends the session on the server; called when the page is closed.
  closeSession(): void {
    const sessionId = this.#sessionId;
    if (sessionId === undefined) return;
    // The page is going away: a failure cannot be shown.
    this.#client.closeSession({ sessionId }, { timeoutMs: CALL_TIMEOUT_MS }).catch(() => undefined);
  }

  dispose(): void {
    this.#life.abort();
    this.#stream?.abort();
    this.#retryNow?.();
  }

  // The error, if it is not about the scene.
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
      // A session that ended also closes its stream; run() handles that.
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
      // Where this page aborted the stream, its reason says more than the resulting error.
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

// Calls back whenever SILENCE_MS pass without a message.
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

// The server's message, if it sent one; messages of network errors do not help a reader.
function reasonOf(error: unknown): string {
  const failure = ConnectError.from(error);
  return NETWORK_CODES.has(failure.code) ? "The server cannot be reached" : failure.rawMessage;
}
