// One person's connection to a session. It opens or joins the session, and sends and receives its
// messages. After a connection loss it joins the same session again. This code does not depend on
// widgets or on a scene's contents.
import type { MessageInitShape } from "@bufbuild/protobuf";
import { Code, ConnectError } from "@connectrpc/connect";
import { BackOff } from "../core/back_off";
import { Participant } from "../core/participant";
import type { SceneVerdict } from "../core/scene_sync";
import type { Connection } from "../core/state";
import type {
  Codec,
  End,
  InteractRequest,
  InteractRequestSchema,
  InteractResponse,
  InteractResponseSchema,
  Joined,
  Refused,
  WindowSchema,
} from "../gen/thunderhead/v1/interact_pb";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import type { BidiCall, BidiListener, CallEnd } from "./interact_socket";
import { NETWORK_CODES } from "./network_codes";
import { reasonOfStatus, retryAfterMs, retryAfterMsOfStatus } from "./retry_info";
import type { ServerCalls } from "./server_calls";

export interface OpenedSession {
  readonly presenterKey: string;
  readonly viewerKey: string;
  // The scene that was sent, with the server's defaults filled in, and its revision.
  readonly completed: Scene;
  readonly revision: bigint;
  // False if the server could not save the session; undefined if the server does not say.
  readonly durable: boolean | undefined;
}

export interface SessionListener {
  // Returns the first scene of a new session.
  sceneToOpen(): Scene;
  // Reports that the server refused to open a session with that scene. sceneToOpen() is called
  // again after a delay.
  openingRefused(message: string): void;
  opened(session: OpenedSession): void;
  // Returns the person's name and the window's size, which the page sends when it joins.
  joining(): JoinDetails;
  // Reports that a new call has joined the session. The frames' sequence numbers restart with each
  // call.
  joined(joined: Joined): void;
  connection(connection: Connection): void;
  // Reports any other message of the session.
  message(message: InteractResponse["message"]): void;
  // Reports that a message was refused.
  refused(refusal: Refusal): void;
  // Reports that the session no longer exists. Returns true to open a new one with the page's
  // scene.
  gone(why: { readonly message: string; readonly forgotten: boolean }): boolean;
}

export interface Refusal {
  readonly subject: RequestCase;
  readonly requestId: bigint;
  readonly code: Code;
  readonly message: string;
  // The refusal's reason in a form for programs; empty if the server gives no reason.
  readonly reason: string;
  // Delay before a retry that the server asks for; 0 if it asks for none.
  readonly retryAfterMs: number;
}

export interface JoinDetails {
  readonly name: string;
  readonly window: MessageInitShape<typeof WindowSchema>;
  readonly codecs: Codec[];
}

export type RequestCase = NonNullable<InteractRequest["message"]["case"]>;
export type RequestMessage = Exclude<
  NonNullable<MessageInitShape<typeof InteractRequestSchema>["message"]>,
  { case: undefined }
>;

export type OpenInteract = (
  listener: BidiListener<typeof InteractResponseSchema>,
) => BidiCall<typeof InteractRequestSchema>;

// After this long without a message the connection is checked, because it may have been lost
// without an error.
export const SILENCE_MS = 15_000;
const FAILED_CHECKS = 2;
const CHECK_TIMEOUT_MS = 4_000;
const JOIN_TIMEOUT_MS = 10_000;
// A call that lasted at least this long after joining resets the back-off. After a shorter call the
// next delay becomes longer.
const SOUND_MS = 2_000;
// Maximum number of sent requests that are remembered, so that a later refusal can be assigned to
// its request.
const MAX_REMEMBERED = 256;

type Outcome =
  // The client joins again after the back-off's delay, but not before the delay `leastMs` that the
  // server gave.
  | { readonly kind: "lost"; readonly reason: string; readonly leastMs: number }
  | { readonly kind: "gone"; readonly message: string; readonly forgotten: boolean }
  // The client waits for retryNow().
  | { readonly kind: "locked"; readonly reason: string }
  | { readonly kind: "disposed" };

interface Call {
  readonly bidi: BidiCall<typeof InteractRequestSchema>;
  readonly requests: Map<bigint, RequestCase>;
  readonly scenes: Map<bigint, { taken(verdict: SceneVerdict): void; lost(why: Error): void }>;
  finish(outcome: Outcome): void;
}

export class SessionClient {
  readonly #calls: ServerCalls;
  readonly #openInteract: OpenInteract;
  readonly #listener: SessionListener;
  readonly #backOff: BackOff;
  readonly #participant: Participant;
  #sessionKey: string | undefined;
  #call: Call | undefined;
  #joined = false;
  #lastRequestId = 0n;
  // True after the client has opened a new session in place of another, until the client has joined
  // it.
  #reopened = false;
  // True while the client waits for openNew().
  #gone = false;
  #disposed = false;
  #wake: (() => void) | undefined;
  // Functions that change the current wait; undefined while nothing waits.
  #reschedule: ((delayMs: number) => void) | undefined;
  #shortenWait: (() => void) | undefined;

  // Joins the session of `sessionKey`. Without a key it opens a new session.
  constructor(
    calls: ServerCalls,
    openInteract: OpenInteract,
    listener: SessionListener,
    sessionKey?: string,
    backOff = new BackOff(),
    participant = new Participant(undefined),
  ) {
    this.#calls = calls;
    this.#openInteract = openInteract;
    this.#listener = listener;
    this.#sessionKey = sessionKey;
    this.#backOff = backOff;
    this.#participant = participant;
  }

  // Runs until dispose().
  async run(): Promise<void> {
    while (!this.#disposed) {
      const outcome = await this.#attempt();
      if (this.#disposed) return;
      if (outcome.kind === "lost") {
        const retryInMs = this.#backOff.next(outcome.leastMs);
        const { attempts } = this.#backOff;
        this.#listener.connection({ kind: "lost", reason: outcome.reason, attempts, retryInMs });
        await this.#waitFor(retryInMs, outcome.leastMs);
      } else if (outcome.kind === "locked") {
        this.#listener.connection(outcome);
        await this.#wait();
      } else if (outcome.kind === "gone") {
        this.#sessionKey = undefined;
        if (this.#listener.gone(outcome)) {
          await this.#reopenSlowly();
          continue;
        }
        this.#listener.connection({ kind: "gone" });
        this.#gone = true;
        await this.#wait();
        this.#gone = false;
      }
    }
  }

  // Opens a new session in place of one that no longer exists.
  openNew(): void {
    if (this.#gone) this.#wake?.();
  }

  // Ends the delay before the next attempt, if there is one.
  retryNow(): void {
    if (!this.#gone) this.#wake?.();
  }

  // Shortens the delay, but not below the delay that the server asked for. The new delay is random
  // again, because other clients got the same network back at the same moment.
  networkIsBack(): void {
    this.#shortenWait?.();
  }

  // Sends a scene. Rejects if the connection is lost. The caller must then send the scene again
  // after joined().
  updateScene(scene: Scene, expectedRevision: bigint): Promise<SceneVerdict> {
    return new Promise((taken, lost) => {
      const requestId = this.send({ case: "updateScene", value: { scene, expectedRevision } });
      if (requestId === undefined) lost(new Error("there is no connection"));
      else this.#call?.scenes.set(requestId, { taken, lost });
    });
  }

  // Sends a message. Returns its id; undefined if it was not sent because there is no connection.
  send(message: RequestMessage): bigint | undefined {
    const call = this.#call;
    if (call === undefined || !this.#joined) return undefined;
    return this.#sendBy(call, message);
  }

  // Acknowledges a frame that is on the screen or will never be shown.
  acknowledge(sequence: bigint, ownView: boolean, videoLost = false): void {
    this.send({ case: "acknowledge", value: { sequence, ownView, videoLost } });
  }

  dispose(): void {
    this.#disposed = true;
    this.#call?.finish({ kind: "disposed" });
    this.#wake?.();
  }

  // Waits before a new session replaces one that no longer exists. The first time it does not wait.
  // If the previous new session could not be joined, the delay grows with each attempt.
  async #reopenSlowly(): Promise<void> {
    const { attempts } = this.#backOff;
    const delayMs = this.#backOff.next();
    if (this.#reopened) {
      const reason = "The server keeps losing its sessions";
      this.#listener.connection({ kind: "lost", reason, attempts, retryInMs: delayMs });
      await this.#wait(delayMs);
    }
    this.#reopened = true;
  }

  async #attempt(): Promise<Outcome> {
    try {
      this.#sessionKey ??= await this.#open();
      if (this.#disposed) return { kind: "disposed" };
      return await this.#interact(this.#sessionKey);
    } catch (error) {
      const failure = ConnectError.from(error);
      if (LOCKED_CODES.has(failure.code)) return { kind: "locked", reason: failure.rawMessage };
      return { kind: "lost", reason: reasonOf(failure), leastMs: retryAfterMs(failure) };
    }
  }

  async #open(): Promise<string> {
    const asked = this.#listener.sceneToOpen();
    try {
      const opened = await this.#calls.createSession(asked);
      this.#listener.opened({
        presenterKey: opened.sessionId,
        viewerKey: opened.viewerKey,
        completed: opened.scene ?? asked,
        revision: opened.sceneRevision,
        durable: opened.durable,
      });
      return opened.sessionId;
    } catch (error) {
      const failure = ConnectError.from(error);
      const full = failure.code === Code.ResourceExhausted;
      if (!full && !NETWORK_CODES.has(failure.code) && !LOCKED_CODES.has(failure.code))
        this.#listener.openingRefused(failure.rawMessage);
      throw failure;
    }
  }

  // Resolves when the call ends.
  #interact(sessionKey: string): Promise<Outcome> {
    return new Promise((resolve) => {
      const silence: SilenceWatch = new SilenceWatch(() => this.#check(call, silence));
      let joinTimer: ReturnType<typeof setTimeout> | undefined;
      let startedAtMs: number | undefined;
      let farewell: Outcome | undefined;
      let opened = false;
      const finish = (outcome: Outcome) => {
        if (this.#call !== call) return;
        this.#call = undefined;
        this.#joined = false;
        clearTimeout(joinTimer);
        silence.dispose();
        call.bidi.cancel();
        for (const scene of call.scenes.values()) scene.lost(new Error("the connection is lost"));
        if (startedAtMs !== undefined && performance.now() - startedAtMs > SOUND_MS)
          this.#backOff.reset();
        resolve(outcome);
      };
      const bidi = this.#openInteract({
        opened: () => {
          opened = true;
          const participantKey = this.#participant.keyFor(sessionKey);
          const value = {
            sessionKey,
            participantKey,
            marksByChanges: true,
            answersChecks: true,
            ...this.#listener.joining(),
          };
          this.#sendBy(call, { case: "join", value });
        },
        message: ({ message }) => {
          if (this.#call !== call) return;
          silence.heard();
          if (message.case === "joined") {
            startedAtMs = performance.now();
            clearTimeout(joinTimer);
            this.#joined = true;
            this.#reopened = false;
            this.#participant.keep(sessionKey, message.value.participantKey);
            this.#listener.connection({ kind: "live" });
            this.#listener.joined(message.value);
          } else if (message.case === "checkAlive") {
            this.#sendBy(call, { case: "alive", value: {} });
          } else if (message.case === "end") {
            farewell = outcomeOfEnd(message.value);
          } else if (message.case === "sceneTaken") {
            const { requestId, sceneRevision } = message.value;
            this.#answerScene(call, requestId, { kind: "taken", revision: sceneRevision });
          } else if (message.case === "refused") this.#refused(call, message.value);
          else this.#listener.message(message);
        },
        ended: (end) => {
          const outcome = farewell ?? outcomeOfStatus(end);
          if (opened || outcome.kind !== "lost") finish(outcome);
          else void this.#whyNotOpened(outcome).then(finish);
        },
      });
      const call: Call = { bidi, requests: new Map(), scenes: new Map(), finish };
      this.#call = call;
      joinTimer = setTimeout(
        () => finish({ kind: "lost", reason: UNREACHABLE, leastMs: 0 }),
        JOIN_TIMEOUT_MS,
      );
    });
  }

  #sendBy(call: Call, message: RequestMessage): bigint {
    this.#lastRequestId += 1n;
    const requestId = this.#lastRequestId;
    call.requests.set(requestId, message.case);
    if (call.requests.size > MAX_REMEMBERED)
      call.requests.delete(requestId - BigInt(MAX_REMEMBERED));
    call.bidi.send({ requestId, message });
    return requestId;
  }

  #refused(call: Call, { requestId, status }: Refused): void {
    const code = (status?.code ?? Code.Unknown) as Code;
    const message = status?.message ?? "";
    if (this.#answerScene(call, requestId, verdictOf(code, message))) return;
    const subject = call.requests.get(requestId);
    if (subject === undefined) return;
    const reason = reasonOfStatus(status);
    const retryAfterMs = retryAfterMsOfStatus(status);
    this.#listener.refused({ subject, requestId, code, message, reason, retryAfterMs });
  }

  // Returns false if the message was not a scene.
  #answerScene(call: Call, requestId: bigint, verdict: SceneVerdict): boolean {
    const scene = call.scenes.get(requestId);
    call.scenes.delete(requestId);
    scene?.taken(verdict);
    return scene !== undefined;
  }

  // Checks whether the server can be reached. Ends the call if FAILED_CHECKS checks in a row fail
  // and no message arrives meanwhile.
  async #check(call: Call, silence: SilenceWatch): Promise<void> {
    const heardBefore = silence.heardCount;
    for (let failures = 0; failures < FAILED_CHECKS; failures += 1) {
      try {
        await this.#calls.serverInfo(CHECK_TIMEOUT_MS);
        return;
      } catch (error) {
        // A server that refuses a call can be reached.
        if (!NETWORK_CODES.has(ConnectError.from(error).code)) return;
      }
      if (silence.heardCount !== heardBefore) return;
    }
    call.finish({ kind: "lost", reason: UNREACHABLE, leastMs: 0 });
  }

  // Finds the reason why the call could not be opened. If the server answers other calls, a proxy
  // or firewall between page and server blocks WebSockets.
  async #whyNotOpened(lost: Outcome & { kind: "lost" }): Promise<Outcome> {
    try {
      await this.#calls.serverInfo(CHECK_TIMEOUT_MS);
      return { ...lost, reason: NO_WEBSOCKET };
    } catch {
      return lost;
    }
  }

  // Waits for `delayMs`. When the network is back, the wait becomes shorter, but not shorter than
  // `leastMs`.
  async #waitFor(delayMs: number, leastMs: number): Promise<void> {
    const startedAtMs = performance.now();
    this.#shortenWait = () => {
      const passedMs = performance.now() - startedAtMs;
      this.#backOff.reset();
      const shorterMs = this.#backOff.next(Math.max(0, leastMs - passedMs));
      if (passedMs + shorterMs < delayMs) this.#reschedule?.(shorterMs);
    };
    await this.#wait(delayMs);
    this.#shortenWait = undefined;
  }

  // Waits for a time. Without a time it waits until it is woken.
  async #wait(delayMs?: number): Promise<void> {
    await new Promise<void>((resolve) => {
      let timer = delayMs === undefined ? undefined : setTimeout(resolve, delayMs);
      this.#wake = () => {
        clearTimeout(timer);
        resolve();
      };
      this.#reschedule = (laterMs) => {
        clearTimeout(timer);
        timer = setTimeout(resolve, laterMs);
      };
    });
    this.#wake = undefined;
    this.#reschedule = undefined;
  }
}

const UNREACHABLE = "The server cannot be reached";
const NO_WEBSOCKET =
  "The server answers, but no WebSocket connection to it can be opened: a proxy or a filter may block it";

// Status codes of a server that does not accept the token, or does not allow the token's role to
// make the call.
const LOCKED_CODES = new Set<Code>([Code.Unauthenticated, Code.PermissionDenied]);

function outcomeOfEnd(end: End): Outcome {
  const message = end.message || "The session has ended";
  if (end.retryAfterMs !== undefined)
    return { kind: "lost", reason: message, leastMs: end.retryAfterMs };
  return { kind: "gone", message, forgotten: false };
}

function outcomeOfStatus(end: CallEnd): Outcome {
  if (end.kind === "broken") return { kind: "lost", reason: end.message, leastMs: 0 };
  if (end.code === Code.NotFound)
    return {
      kind: "gone",
      message: "The server no longer has this session",
      forgotten: true,
    };
  if (LOCKED_CODES.has(end.code as Code)) return { kind: "locked", reason: end.message };
  const reason = end.code === 0 ? "The server ended the connection" : end.message || UNREACHABLE;
  return { kind: "lost", reason, leastMs: end.retryAfterMs };
}

function verdictOf(code: Code, message: string): SceneVerdict {
  if (code === Code.Aborted) return { kind: "stale" };
  if (code === Code.ResourceExhausted || code === Code.Unavailable)
    return { kind: "busy", message };
  return { kind: "refused", message };
}

// Calls `onSilence` whenever SILENCE_MS pass without a message.
class SilenceWatch {
  readonly #onSilence: () => Promise<void>;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #disposed = false;
  #heardCount = 0;

  constructor(onSilence: () => Promise<void>) {
    this.#onSilence = onSilence;
  }

  get heardCount(): number {
    return this.#heardCount;
  }

  heard(): void {
    this.#heardCount += 1;
    this.#wait();
  }

  #wait(): void {
    clearTimeout(this.#timer);
    if (this.#disposed) return;
    this.#timer = setTimeout(() => void this.#onSilence().then(() => this.#wait()), SILENCE_MS);
  }

  dispose(): void {
    this.#disposed = true;
    clearTimeout(this.#timer);
  }
}

// Returns the server's message. For a network error, whose message does not help a reader, returns
// UNREACHABLE.
function reasonOf(failure: ConnectError): string {
  return NETWORK_CODES.has(failure.code) ? UNREACHABLE : failure.rawMessage;
}
