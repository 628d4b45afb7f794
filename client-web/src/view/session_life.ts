// This page's part in a session. It opens or joins the session, synchronizes the page's scene with
// the session's, and handles the session's messages.

import { create } from "@bufbuild/protobuf";
import { Code } from "@connectrpc/connect";
import { poseOfCamera } from "../core/camera";
import { ControlResumption } from "../core/control_resumption";
import type { Marking } from "../core/marking";
import type { Later } from "../core/newest";
import type { OwnKeys } from "../core/own_keys";
import type { RevisionLedger } from "../core/revision_ledger";
import { outputSize, withOutput } from "../core/scene";
import { SceneSync, type SceneVerdict } from "../core/scene_sync";
import type { Connection, PageState } from "../core/state";
import type { Frame, Problem } from "../gen/thunderhead/v1/frame_pb";
import {
  Codec,
  type InteractResponse,
  type Joined,
  type Presence,
  Role,
} from "../gen/thunderhead/v1/interact_pb";
import { type Scene, SceneSchema } from "../gen/thunderhead/v1/scene_pb";
import type {
  JoinDetails,
  OpenedSession,
  Refusal,
  SessionClient,
  SessionListener,
} from "../transport/session_client";
import type { Notes } from "./notes";
import type { Screen } from "./screen";
import type { StormsOnServer } from "./storms_on_server";
import type { Viewpoint } from "./viewpoint";

// Subject and text of the notice that the server could not save the session.
const NO_STORMS = "no-storms";
const NOT_SAVED = "not-saved";
const NOT_SAVED_TEXT =
  "This session is not saved: it ends with the server, unless the server can save it later.";

export interface SessionLifeParts {
  client(): SessionClient;
  screen(): Screen;
  viewpoint(): Viewpoint;
  marking(): Marking;
  readonly state: PageState;
  readonly keys: OwnKeys;
  readonly ledger: RevisionLedger;
  readonly notes: Notes;
  readonly storms: StormsOnServer;
  pausePlayback(): void;
  takeControl(): void;
  writeAddress(): void;
  nowMs(): number;
  onNextPaint(callback: (nowMs: number) => void): () => void;
  later: Later;
}

export class SessionLife implements SessionListener {
  codecs: Codec[] = [Codec.JPEG];
  // True if this page sets the session's picture size. It is false at first for a page that joins
  // another person's session, until the person chooses a resolution or opens a session.
  setsOutput: boolean;
  readonly #parts: SessionLifeParts;
  readonly #sync: SceneSync;
  // The presenter key with which the page joins; undefined if it joins with the viewers' key.
  #presenterKey: string | undefined;
  // True after this page has opened a session, until the first presence message of this session.
  #opened = false;
  readonly #resumption = new ControlResumption();
  #newestProblem: Problem | undefined;

  constructor(parts: SessionLifeParts) {
    this.#parts = parts;
    const { state, keys, ledger } = parts;
    const viewerKey = state.session.viewerKey.peek();
    if (viewerKey !== undefined) this.#presenterKey = keys.presenterKey(viewerKey);
    this.setsOutput = viewerKey === undefined || this.#presenterKey !== undefined;
    this.#sync = new SceneSync({
      scene: () => state.scene.peek(),
      adopt: (scene) => state.adoptScene(scene),
      complete: (scene) => state.adoptCompleted(scene),
      changedByOthers: (scene, revision) => ledger.told(scene.timeIndex ?? 0, revision),
      send: (scene, expectedRevision) => this.#send(scene, expectedRevision),
      taken: () => state.dismiss("refused"),
      agreed: (revision) => parts.screen().tellAgreed(revision),
      refused: (text) => parts.notes.problem("refused", text),
      onNextPaint: (callback) => parts.onNextPaint(callback),
      later: parts.later,
    });
    state.onEdit((edit) => this.#sync.edited(edit));
  }

  // Returns the key with which to join.
  get key(): string | undefined {
    return this.#presenterKey ?? this.#parts.state.session.viewerKey.peek();
  }

  // Returns true once the picture of this time is on the screen. Before this page sends its first
  // scene, every frame counts, because the frame on the screen has the scene's time.
  isTimeShown(index: number): boolean {
    if (this.#sync.unsettled || this.#parts.screen().shown === undefined) return false;
    return (this.#parts.ledger.shownTimeIndex ?? index) === index;
  }

  // Handles a frame that is on the screen.
  shown(frame: Frame, nowMs: number): void {
    if (frame.ownView) this.#parts.viewpoint().ownView.placed(frame.camera);
    else {
      this.#parts.ledger.shown(frame.sceneRevision, nowMs);
      this.adoptCamera();
    }
    const problem = this.#newestProblem;
    if (problem?.ownView === frame.ownView && frame.sceneRevision >= problem.sceneRevision)
      this.#parts.state.dismiss("problem");
  }

  // Adopts a frame's camera once the frame shows the newest scene.
  adoptCamera(): void {
    const frame = this.#parts.screen().shown;
    if (frame === undefined || frame.ownView || this.#sync.unsettled) return;
    if (frame.sceneRevision >= this.#sync.revision) this.#parts.state.adoptCamera(frame.camera);
  }

  // Adopts the shown frame's camera if the scene's camera has no values. This is needed because a
  // frame may arrive before the response that names its revision.
  adoptOpenCamera(): void {
    if (poseOfCamera(this.#parts.state.scene.peek().camera) === undefined) this.adoptCamera();
  }

  sendWindow(): void {
    this.#parts.client().send({ case: "window", value: this.#parts.screen().window() });
  }

  sendOutputSize(): void {
    const { state } = this.#parts;
    const { output } = state.scene.peek();
    const size = this.#outputSize();
    if (!this.setsOutput || state.session.me.peek() === undefined) return;
    if (output?.widthPx === size.widthPx && output?.heightPx === size.heightPx) return;
    state.edit((scene) => withOutput(scene, size), "unrecorded");
  }

  dispose(): void {
    this.#sync.dispose();
  }

  // The methods of SessionListener follow.

  sceneToOpen(): Scene {
    this.setsOutput = true;
    const { scene } = this.#parts.state;
    this.#parts.state.adoptScene(withOutput(scene.value, this.#outputSize()));
    this.#sync.opening();
    return scene.value;
  }

  openingRefused(message: string): void {
    // If no storm was chosen, the server has none yet. The message is removed once a session opens.
    // Otherwise it stays, because the page then opens a session with another storm.
    const chosen = this.#parts.state.scene.peek().stormId !== "";
    this.#parts.notes.problem(chosen ? "refused" : NO_STORMS, message);
    this.#parts.state.adoptScene(create(SceneSchema));
  }

  opened(opened: OpenedSession): void {
    this.#presenterKey = opened.presenterKey;
    this.#opened = true;
    this.#resumption.end();
    this.#parts.keys.keep(opened.viewerKey, opened.presenterKey);
    this.#parts.state.session.viewerKey.value = opened.viewerKey;
    this.#sync.opened(opened.completed, opened.revision);
    this.#parts.state.dismiss(NO_STORMS);
    this.#parts.writeAddress();
    if (opened.durable === false) this.#parts.notes.problem(NOT_SAVED, NOT_SAVED_TEXT);
    else this.#parts.state.dismiss(NOT_SAVED);
  }

  joining(): JoinDetails {
    const window = this.#parts.screen().window();
    return { name: this.#parts.keys.name, window, codecs: this.codecs };
  }

  joined(joined: Joined): void {
    const { session } = this.#parts.state;
    const presenting = joined.role === Role.PRESENTER;
    const before = session.me.peek();
    if (before !== undefined && !this.#opened)
      this.#resumption.rejoined({
        viewerId: before.viewerId,
        steered: session.steering.peek(),
        people: session.people.peek(),
      });
    session.joined(joined);
    if (presenting && this.#presenterKey !== undefined)
      this.#parts.keys.keep(joined.viewerKey, this.#presenterKey);
    this.#parts.ledger.startSession();
    this.#sync.forget();
    this.#parts.screen().startCall();
    this.#parts.viewpoint().ownView.resume();
    void this.#parts.storms.learn();
  }

  connection(connection: Connection): void {
    this.#parts.state.connection.value = connection;
    if (connection.kind !== "live") this.#sync.hold();
  }

  message(message: InteractResponse["message"]): void {
    const { session } = this.#parts.state;
    switch (message.case) {
      case "scene":
        if (message.value.scene !== undefined)
          this.#sync.told(message.value.scene, message.value.sceneRevision);
        break;
      case "frame":
        this.#parts.screen().flow.offer(message.value);
        break;
      case "problem":
        this.#problem(message.value);
        break;
      case "presence":
        this.#takePresence(message.value);
        break;
      case "pointers":
        session.pointers.value = message.value.pointers;
        break;
      case "marks":
        session.takeMarks(message.value);
        break;
      case "timesInMemory":
        this.#parts.state.timesInMemory.value = message.value;
        break;
      case "catalogueChanged":
        void this.#parts.storms.changed();
        break;
    }
  }

  refused({ subject, requestId, code, message, reason, retryAfterMs }: Refusal): void {
    const { ownView } = this.#parts.viewpoint();
    // A refused pointer, acknowledgement or camera motion needs no notice, because it only came too
    // late or too often.
    if (subject === "point" || subject === "acknowledge") return;
    if (subject === "moveCamera") {
      // This code means that the server has ended the own view, which this page may not know yet.
      if (code === Code.FailedPrecondition) ownView.end();
      return;
    }
    if (subject === "addMark") {
      const againMs = reason === "MARKS_TOO_FAST" ? retryAfterMs : undefined;
      if (this.#parts.marking().refused(requestId, againMs)) return;
    }
    if (subject === "detach") ownView.end();
    const text = code === Code.PermissionDenied && message === "" ? "This is not allowed" : message;
    this.#parts.notes.say("refused-request", text);
  }

  gone(why: { readonly message: string; readonly forgotten: boolean }): boolean {
    const { session } = this.#parts.state;
    const presented = this.#presenterKey !== undefined;
    this.#presenterKey = undefined;
    if (session.viewerKey.peek() !== undefined)
      this.#parts.keys.forget(session.viewerKey.peek() ?? "");
    if (presented && why.forgotten) {
      this.#parts.notes.say(
        "session",
        "The server had lost the session; this is a new one with the same scene.",
      );
      return true;
    }
    session.end(why.message);
    this.#parts.pausePlayback();
    return false;
  }

  #takePresence(presence: Presence): void {
    const { state, notes } = this.#parts;
    const { session } = state;
    const steeredBefore = session.steering.peek();
    session.takePresence(presence);
    if (session.steering.peek()) {
      this.#parts.viewpoint().follow();
      this.#resumption.end();
      this.#sync.allow();
      if (this.setsOutput) this.sendOutputSize();
      if (!steeredBefore && !this.#opened && !session.alone.peek())
        notes.say("control", "You steer");
    } else {
      this.#sync.hold();
      this.#parts.pausePlayback();
      const resumption = this.#resumption.of(presence, session.presenting.peek());
      const opens = this.#opened && presence.steeringViewerId === 0n;
      if (opens || resumption === "takes") this.#parts.takeControl();
      else if (resumption === "lost")
        this.#sync.discard(() => {
          const why = session.editBlock.peek() ?? "";
          notes.say("control", `Your last change was not made. ${why}`);
        });
    }
    this.#opened = false;
  }

  #problem(problem: Problem): void {
    this.#newestProblem = problem;
    if (!problem.ownView) this.#parts.ledger.settled(problem.sceneRevision);
    this.#parts.notes.problem("problem", problem.message);
    // The cause may be that the scene's storm no longer exists, so the list of storms is fetched
    // again.
    void this.#parts.storms.learn();
  }

  #outputSize() {
    const { widthPx, heightPx } = this.#parts.screen().size;
    return outputSize(widthPx, heightPx, this.#parts.state.resolution.peek());
  }

  async #send(scene: Scene, expectedRevision: bigint): Promise<SceneVerdict> {
    const entry = this.#parts.ledger.sent(scene.timeIndex ?? 0, this.#parts.nowMs());
    try {
      const verdict = await this.#parts.client().updateScene(scene, expectedRevision);
      if (verdict.kind === "taken") entry.accepted(verdict.revision);
      else entry.refused();
      return verdict;
    } catch (error) {
      entry.refused();
      throw error;
    }
  }
}
