// One person's place in a session: opens or joins it, sends and receives its messages, and comes back to the same session
// when the connection is lost. Independent of widgets and of a scene's contents.
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
  // The scene that was sent with the server's defaults filled in, and its revision.
  readonly completed: Scene;
  readonly revision: bigint;
  // False if the server could not save it; undefined if the server does not say.
  readonly durable: boolean | undefined;
}

export interface SessionListener {
  // The scene that a new session is to start with.
  sceneToOpen(): Scene;
  // The server refuses to open a session with that scene; sceneToOpen() is called again after a delay.
  openingRefused(message: string): void;
  opened(session: OpenedSession): void;
  // The name and window to join with.
  joining(): JoinDetails;
  // A new call has begun: sequence numbers restart.
  joined(joined: Joined): void;
  connection(connection: Connection): void;
  // Anything else that the session says.
  message(message: InteractResponse["message"]): void;
  // A message was not obeyed.
  refused(refusal: Refusal): void;
  // The session is gone. Returns true if a new one is to be opened with the page's scene.
  gone(why: { readonly message: string; readonly forgotten: boolean }): boolean;
}

export interface Refusal {
  readonly subject: RequestCase;
  readonly requestId: bigint;
  readonly code: Code;
  readonly message: string;
  // For programs; empty if the server gives none.
  readonly reason: string;
  // 0 if the server gives no time to try again.
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

// After this long without a message the connection is checked: it may have been lost without an error.
export const SILENCE_MS = 15_000;
const FAILED_CHECKS = 2;
const CHECK_TIMEOUT_MS = 4_000;
const JOIN_TIMEOUT_MS = 10_000;
// A call that lasted this long resets the back-off; one that breaks sooner lengthens the next wait.
const SOUND_MS = 2_000;
// Requests whose refusal can be told apart.
const MAX_REMEMBERED = 256;

type Outcome =
  // Come back: after the server's delay, if it gave one.
  | { readonly kind: "lost"; readonly reason: string; readonly leastMs: number }
  | { readonly kind: "gone"; readonly message: string; readonly forgotten: boolean }
  // Waits for retryNow().
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
  // A session was opened in place of another, and has not been joined yet.
  #reopened = false;
  // Waits for openNew().
  #gone = false;
  #disposed = false;
  #wake: (() => void) | undefined;
  // Of the wait that goes on.
  #reschedule: ((delayMs: number) => void) | undefined;
  #shortenWait: (() => void) | undefined;

  // Joins the session of `sessionKey`, or without one opens a new session.
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

  // Opens a new session in place of one that is gone.
  openNew(): void {
    if (this.#gone) this.#wake?.();
  }

  // Ends the wait before the next attempt, if there is one.
  retryNow(): void {
    if (!this.#gone) this.#wake?.();
  }

  // Waits only a little longer, and as long as the server asked for. Whoever lost the same network has it back at the same
  // moment, so that the attempts are spread again.
  networkIsBack(): void {
    this.#shortenWait?.();
  }

  // Rejects if the connection is lost; the caller must send the scene again after joined().
  updateScene(scene: Scene, expectedRevision: bigint): Promise<SceneVerdict> {
    return new Promise((taken, lost) => {
      const requestId = this.send({ case: "updateScene", value: { scene, expectedRevision } });
      if (requestId === undefined) lost(new Error("there is no connection"));
      else this.#call?.scenes.set(requestId, { taken, lost });
    });
  }

  // Returns the message's id; undefined if there is no connection, and it is not sent.
  send(message: RequestMessage): bigint | undefined {
    const call = this.#call;
    if (call === undefined || !this.#joined) return undefined;
    return this.#sendBy(call, message);
  }

  // The frame is on the screen, or will never be.
  acknowledge(sequence: bigint, ownView: boolean, videoLost = false): void {
    this.send({ case: "acknowledge", value: { sequence, ownView, videoLost } });
  }

  dispose(): void {
    this.#disposed = true;
    this.#call?.finish({ kind: "disposed" });
    this.#wake?.();
  }

  // At once, but where no new session could be joined since the last time, later and later.
  async #reopenSlowly(): Promise<void> {
    const { attempts } = this.#backOff;
    const delayMs = this.#backOff.next();
    if (this.#reopened) {
      const reason = "The server loses its sessions";
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

  // Ends with the call.
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

  // False if the message was no scene.
  #answerScene(call: Call, requestId: bigint, verdict: SceneVerdict): boolean {
    const scene = call.scenes.get(requestId);
    call.scenes.delete(requestId);
    scene?.taken(verdict);
    return scene !== undefined;
  }

  // Ends the call if the server cannot be reached twice in a row and nothing is heard meanwhile.
  async #check(call: Call, silence: SilenceWatch): Promise<void> {
    const heardBefore = silence.heardCount;
    for (let failures = 0; failures < FAILED_CHECKS; failures += 1) {
      try {
        await this.#calls.serverInfo(CHECK_TIMEOUT_MS);
        return;
      } catch (error) {
        // A server that refuses is there.
        if (!NETWORK_CODES.has(ConnectError.from(error).code)) return;
      }
      if (silence.heardCount !== heardBefore) return;
    }
    call.finish({ kind: "lost", reason: UNREACHABLE, leastMs: 0 });
  }

  // Where the server answers other calls, something between lets no WebSocket through.
  async #whyNotOpened(lost: Outcome & { kind: "lost" }): Promise<Outcome> {
    try {
      await this.#calls.serverInfo(CHECK_TIMEOUT_MS);
      return { ...lost, reason: NO_WEBSOCKET };
    } catch {
      return lost;
    }
  }

  // Waits for `delayMs`; once the network is back, for a short time, which does not end before `leastMs` of it.
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

  // For ever, without a time.
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
  "The server answers, but no WebSocket to it opens: a proxy or a filter may block it";

// The server does not know who this is, or that role may not.
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
      message: "The server does not have this session any more",
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

// Calls back whenever SILENCE_MS pass without a message.
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

// The server's message, if it sent one; messages of network errors do not help a reader.
function reasonOf(failure: ConnectError): string {
  return NETWORK_CODES.has(failure.code) ? UNREACHABLE : failure.rawMessage;
}
