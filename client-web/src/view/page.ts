// Connects the parts: the session's messages with the state, edits and camera motions with the session, frames with the
// canvas. Owns the parts; dispose() ends them.

import { create } from "@bufbuild/protobuf";
import { Code, type Transport } from "@connectrpc/connect";
import { effect, untracked } from "@preact/signals-core";
import { AccessToken } from "../core/access_token";
import {
  type CameraKind,
  homeCamera,
  type Pose,
  poseOfCamera,
  standingAzimuthDeg,
} from "../core/camera";
import { encodingOf, pictureBytes } from "../core/encoding";
import { FrameRate } from "../core/frame_rate";
import { type MarkedPicture, Marking } from "../core/marking";
import type { Later } from "../core/newest";
import { OwnKeys } from "../core/own_keys";
import { OwnView } from "../core/own_view";
import { Playback } from "../core/playback";
import type { WorldRay } from "../core/projection";
import { RevisionLedger } from "../core/revision_ledger";
import { outputSize, withCamera, withOutput, withStorm, withTime } from "../core/scene";
import { SceneSync, type SceneVerdict } from "../core/scene_sync";
import type { Tool } from "../core/session_state";
import { type Connection, PageState } from "../core/state";
import type { Frame, Problem } from "../gen/thunderhead/v1/frame_pb";
import {
  Codec,
  type InteractResponse,
  type Joined,
  type Presence,
  Role,
} from "../gen/thunderhead/v1/interact_pb";
import { type Scene, SceneSchema } from "../gen/thunderhead/v1/scene_pb";
import { ServerCalls } from "../transport/server_calls";
import {
  type JoinDetails,
  type OpenedSession,
  type OpenInteract,
  type RequestCase,
  SessionClient,
  type SessionListener,
} from "../transport/session_client";
import { Addresses } from "./addresses";
import { CanvasPlace } from "./canvas_place";
import { learnDecodable } from "./decodable";
import { attachKeyboard } from "./keyboard";
import { readLink } from "./link";
import { PictureFlow } from "./picture_flow";
import { SessionActions } from "./session_actions";
import { StormsOnServer } from "./storms_on_server";

const PACE_EVERY_MS = 500;
const NOTE_MS = 6000;
// A page that is looked at says so, so that the session does not expire under a still picture.
const STILL_HERE_EVERY_MS = 30_000;
// Narrower windows start with the panel closed.
const NARROW_PX = 700;
// Of what a camera that does not turn around a target looks at.
const TYPICAL_DISTANCE_M = 30_000;

// The person has asked the browser to save data; not in every browser.
type NetworkNavigator = Navigator & { readonly connection?: { readonly saveData?: boolean } };

export class Page implements SessionListener {
  readonly state = new PageState();
  readonly playback: Playback;
  readonly marking: Marking;
  readonly actions: SessionActions;
  readonly addresses: Addresses;
  readonly #keys: OwnKeys;
  readonly #window: Window;
  readonly #token: AccessToken;
  readonly #calls: ServerCalls;
  readonly #client: SessionClient;
  readonly #storms: StormsOnServer;
  readonly #sync: SceneSync;
  readonly #flow: PictureFlow;
  readonly #place: CanvasPlace;
  readonly #ownView: OwnView;
  readonly #ledger = new RevisionLedger();
  readonly #rate = new FrameRate();
  readonly #listening = new AbortController();
  readonly #disposals: (() => void)[] = [];
  // The key that the page joins with, if it is the presenter's.
  #presenterKey: string | undefined;
  // True until the first presence of a session that this page opened.
  #opened = false;
  // It steered as a presenter when the connection was lost; the server may still see that connection steer.
  #resumesSteering = false;
  // False for who steers another's session, which keeps its picture size.
  #setsOutput: boolean;
  #shown: Frame | undefined;
  #newestProblem: Problem | undefined;
  #running = false;
  #codecs: Codec[] = [Codec.JPEG];

  constructor(
    transport: Transport,
    openInteract: OpenInteract,
    window: Window,
    token = new AccessToken(undefined),
  ) {
    this.#window = window;
    this.#token = token;
    const { session } = this.state;
    const link = readLink(window.location.href);
    if (link.scene !== undefined) this.state.adoptScene(link.scene);
    this.#keys = new OwnKeys(storageOf(window));
    session.viewerKey.value = link.viewerKey;
    if (link.viewerKey !== undefined) this.#presenterKey = this.#keys.presenterKey(link.viewerKey);
    this.#setsOutput = link.viewerKey === undefined || this.#presenterKey !== undefined;
    this.state.panelOpen.value = window.innerWidth >= NARROW_PX;

    this.#calls = new ServerCalls(transport);
    const key = this.#presenterKey ?? link.viewerKey;
    this.#client = new SessionClient(this.#calls, openInteract, this, key);
    this.actions = new SessionActions(this.#client, this.#calls, this.#keys, this.state);
    this.addresses = new Addresses(window, this.state);
    this.#storms = new StormsOnServer(this.#calls, this.state);
    const onNextPaint = (callback: (nowMs: number) => void) => {
      const request = window.requestAnimationFrame(callback);
      return () => window.cancelAnimationFrame(request);
    };
    const later: Later = (delayMs, callback) => {
      const timer = setTimeout(callback, delayMs);
      return () => clearTimeout(timer);
    };
    this.#sync = new SceneSync({
      scene: () => this.state.scene.peek(),
      adopt: (scene) => this.state.adoptScene(scene),
      complete: (scene) => this.state.adoptRendering(scene.rendering),
      changedByOthers: (scene, revision) => this.#ledger.told(scene.timeIndex ?? 0, revision),
      send: (scene, expectedRevision) => this.#send(scene, expectedRevision),
      taken: () => this.state.dismiss("refused"),
      refused: (text) => this.state.notify({ subject: "refused", text, severity: "problem" }),
      onNextPaint,
      later,
    });
    this.#flow = new PictureFlow({
      acknowledge: (sequence, ownView, videoLost) =>
        this.#client.acknowledge(sequence, ownView, videoLost),
      wantsOwnView: () => session.lookingAround.peek(),
      painted: (frame) => this.#painted(frame),
      undecodable: (frame) => this.#undecodable(frame),
      onNextPaint,
    });
    this.#place = new CanvasPlace(window, this.#flow, {
      move: (motion) => this.move(motion),
      tool: () => this.marking.tool(),
      resized: () => {
        if (this.#shown !== undefined) this.state.pictureBox.value = this.#place.boxOf(this.#shown);
      },
      resizeRested: () => {
        this.#sendWindow();
        this.#sendOutputSize();
      },
    });
    this.#ownView = new OwnView(session.lookingAround, {
      detach: (camera) => this.#client.send({ case: "detach", value: { camera } }),
      moveCamera: (camera) => this.#client.send({ case: "moveCamera", value: { camera } }),
      follow: () => this.#client.send({ case: "follow", value: {} }),
      later,
    });
    this.marking = new Marking(session, {
      picture: () => this.#markedPicture(),
      point: (ray) =>
        this.#client.send({
          case: "point",
          value: ray === undefined ? {} : { ray: rayMessage(ray) },
        }),
      addMark: (rays) =>
        this.#client.send({ case: "addMark", value: { rays: rays.map(rayMessage) } }),
      later,
    });
    this.playback = new Playback({
      timeCount: () => this.state.timeCount.value,
      timeIndex: () => this.state.timeIndex.value,
      isShown: (index) => this.#isTimeShown(index),
      showTime: (index) => this.showTime(index),
      onNextPaint,
    });
    this.state.onEdit((edit) => this.#sync.edited(edit));
    this.#listen();
  }

  // Paints pictures on this canvas from now on. Returns the function that detaches it.
  attachCanvas(canvas: HTMLCanvasElement): () => void {
    const detach = this.#place.attach(canvas);
    if (!this.#running) {
      this.#running = true;
      void this.#run();
    }
    return detach;
  }

  // The camera of the session for who steers, else the own view's.
  move(motion: (pose: Pose) => Pose): void {
    if (this.state.session.editBlock.peek() === undefined) this.state.move(motion);
    else if (this.#startsLookingAround()) this.#ownView.move(motion, this.#shownPose());
  }

  // Tries again with this token.
  signIn(token: string): void {
    this.#token.set(token);
    this.state.connection.value = { kind: "connecting" };
    this.#client.retryNow();
  }

  follow(): void {
    this.#ownView.follow();
  }

  showTime(index: number): void {
    if (index !== this.state.timeIndex.value) this.state.edit((scene) => withTime(scene, index));
  }

  // Shows a storm's last time, as the server does by default.
  showStorm(stormId: string): void {
    this.playback.pause();
    const shown = this.state.storms.value.find((storm) => storm.id === stormId);
    const last = (shown?.timeCount ?? 1) - 1;
    this.state.edit((scene) => withStorm(scene, stormId, last));
  }

  // Asks the server to make the cloud set in the panel, and shows it.
  async makeCloud(): Promise<void> {
    const stormId = await this.#storms.makeCloud();
    if (stormId === undefined) return;
    this.showStorm(stormId);
    this.home();
  }

  stopCloud(): void {
    this.#storms.stopCloud();
  }

  // Deletes the cloud that is shown, for all viewers, and shows another storm.
  async deleteCloud(): Promise<void> {
    const { storms, stormId } = this.state;
    const deleted = stormId.value;
    const other = storms.value.find((storm) => storm.id !== deleted);
    if (other !== undefined) this.showStorm(other.id);
    await this.#storms.deleteCloud(deleted);
  }

  // A camera of that kind that shows the whole storm.
  showCamera(kind: CameraKind): void {
    if (this.state.session.editBlock.peek() === undefined)
      this.state.edit((scene) => withCamera(scene, homeCamera(kind)));
    else if (this.#startsLookingAround()) this.#ownView.show(homeCamera(kind));
  }

  home(): void {
    this.showCamera(this.state.cameraKind.value);
  }

  togglePanel(): void {
    this.state.panelOpen.value = !this.state.panelOpen.value;
  }

  togglePopover(name: "share" | "people"): void {
    const { popover } = this.state;
    popover.value = popover.value === name ? undefined : name;
  }

  toggleTool(tool: Exclude<Tool, "camera">): void {
    const { session } = this.state;
    this.marking.withdrawPointer();
    if (!session.mayMark.peek()) return;
    session.tool.value = session.tool.value === tool ? "camera" : tool;
  }

  setResolution(share: number): void {
    this.state.resolution.value = share;
    this.#setsOutput = true;
    this.#sendOutputSize();
  }

  async copyLink(): Promise<void> {
    if (await this.addresses.copyLink()) this.#note("link", "Link copied");
    else {
      const text = this.addresses.viewersLink(true) ?? "";
      this.state.notify({ subject: "link", text, severity: "note" });
    }
  }

  dispose(): void {
    this.#storms.dispose();
    this.addresses.dispose();
    this.#listening.abort();
    for (const dispose of this.#disposals) dispose();
    this.playback.dispose();
    this.marking.dispose();
    this.#ownView.dispose();
    this.#sync.dispose();
    this.#client.dispose();
    this.#calls.dispose();
    this.#flow.dispose();
  }

  // SessionListener.

  sceneToOpen(): Scene {
    this.#setsOutput = true;
    const { scene, resolution } = this.state;
    const { widthPx, heightPx } = this.#place.size;
    const size = outputSize(widthPx, heightPx, resolution.value);
    this.state.adoptScene(withOutput(scene.value, size));
    this.#sync.opening();
    return scene.value;
  }

  openingRefused(message: string): void {
    this.state.notify({ subject: "refused", text: message, severity: "problem" });
    this.state.adoptScene(create(SceneSchema));
  }

  opened(opened: OpenedSession): void {
    this.#presenterKey = opened.presenterKey;
    this.#opened = true;
    this.#keys.keep(opened.viewerKey, opened.presenterKey);
    this.state.session.viewerKey.value = opened.viewerKey;
    this.#sync.opened(opened.completed, opened.revision);
    this.addresses.write();
  }

  joining(): JoinDetails {
    return { name: this.#keys.name, window: this.#windowMessage(), codecs: this.#codecs };
  }

  joined(joined: Joined): void {
    const { session } = this.state;
    const presenting = joined.role === Role.PRESENTER;
    this.#resumesSteering = presenting && session.steering.peek();
    session.joined(joined);
    if (presenting && this.#presenterKey !== undefined)
      this.#keys.keep(joined.viewerKey, this.#presenterKey);
    this.#ledger.startSession();
    this.#sync.forget();
    this.#flow.startCall();
    this.#ownView.resume();
    void this.#storms.learn();
  }

  connection(connection: Connection): void {
    this.state.connection.value = connection;
    if (connection.kind !== "live") this.#sync.hold();
  }

  message(message: InteractResponse["message"]): void {
    const { session } = this.state;
    switch (message.case) {
      case "scene":
        if (message.value.scene !== undefined)
          this.#sync.told(message.value.scene, message.value.sceneRevision);
        break;
      case "frame":
        this.#flow.offer(message.value);
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
        session.takeMarks(message.value.marks);
        break;
      case "catalogueChanged":
        void this.#storms.changed();
        break;
    }
  }

  refused(subject: RequestCase, requestId: bigint, code: Code, message: string): void {
    // A late or a second pointer, acknowledgement or motion is of no interest.
    if (subject === "point" || subject === "acknowledge") return;
    if (subject === "moveCamera") {
      // The server has ended the own view; this page may not have been told of it.
      if (code === Code.FailedPrecondition) this.#ownView.end();
      return;
    }
    if (subject === "addMark") this.state.session.dropPendingMark(requestId);
    if (subject === "detach") this.#ownView.end();
    const text = code === Code.PermissionDenied && message === "" ? "This is not allowed" : message;
    this.#note("refused-request", text);
  }

  gone(why: { readonly message: string; readonly forgotten: boolean }): boolean {
    const { session } = this.state;
    const presented = this.#presenterKey !== undefined;
    this.#presenterKey = undefined;
    if (session.viewerKey.peek() !== undefined) this.#keys.forget(session.viewerKey.peek() ?? "");
    if (presented && why.forgotten) {
      this.#note(
        "session",
        "The server had lost the session; this is a new one with the same scene.",
      );
      return true;
    }
    session.end(why.message);
    this.playback.pause();
    return false;
  }

  async #run(): Promise<void> {
    const { codecs, whyNoVideo } = await learnDecodable(this.#window);
    this.#codecs = codecs;
    this.state.whyNoVideo.value = whyNoVideo;
    await this.#client.run();
  }

  #now(): number {
    return this.#window.performance.now();
  }

  #listen(): void {
    const options = { signal: this.#listening.signal };
    const window = this.#window;
    window.addEventListener("online", () => this.#client.retryNow(), options);
    window.document.addEventListener("visibilitychange", () => this.#sendWindow(), options);
    const pace = setInterval(() => this.#takePace(), PACE_EVERY_MS);
    const stillHere = setInterval(() => {
      if (!window.document.hidden) this.#sendWindow();
    }, STILL_HERE_EVERY_MS);
    this.#disposals.push(
      () => clearInterval(pace),
      () => clearInterval(stillHere),
      attachKeyboard(window, {
        move: (motion) => this.move(motion),
        home: () => this.home(),
        togglePanel: () => this.togglePanel(),
        togglePlay: () => this.#mayPlay() && this.playback.toggle(),
        stepTime: (by) => this.#mayPlay() && this.playback.step(by),
        toggleTool: (tool) => this.toggleTool(tool),
        escape: () => this.#escape(),
      }),
      effect(() => this.#storms.describeAfterRest(this.playback.playing.value)),
      effect(() => {
        if (!this.state.session.mayLookAround.value) untracked(() => this.follow());
      }),
      effect(() => {
        this.state.session.lookingAround.value;
        untracked(() => this.#flow.viewChanged());
      }),
      effect(() => {
        if (!this.state.session.mayMark.value) this.state.session.tool.value = "camera";
      }),
    );
  }

  #takePresence(presence: Presence): void {
    const { session } = this.state;
    const steeredBefore = session.steering.peek();
    session.takePresence(presence);
    if (session.steering.peek()) {
      this.#ownView.follow();
      this.#sync.allow();
      if (this.#setsOutput) this.#sendOutputSize();
      if (!steeredBefore && !this.#opened) this.#note("control", "You steer");
    } else {
      this.#sync.hold();
      this.playback.pause();
      if (this.#opened && presence.steeringViewerId === 0n) this.actions.takeControl();
      else if (this.#resumesSteering && presenterSteers(presence)) this.actions.takeControl();
      else if (this.#sync.unsettled) {
        this.#sync.discard();
        this.#note("control", `Your last change was not taken. ${session.editBlock.peek() ?? ""}`);
      }
    }
    this.#opened = false;
    this.#resumesSteering = false;
  }

  #startsLookingAround(): boolean {
    const { session, connection } = this.state;
    if (session.ended.peek() !== undefined || connection.peek().kind !== "live") return false;
    if (session.mayLookAround.peek()) return true;
    this.#note("locked", "The presenter has locked the view: everybody sees the same");
    return false;
  }

  #mayPlay(): boolean {
    return this.state.session.editBlock.peek() === undefined;
  }

  #shownPose(): Pose | undefined {
    return poseOfCamera(this.#shown?.camera) ?? this.state.pose.peek();
  }

  #markedPicture(): MarkedPicture | undefined {
    const box = this.state.pictureBox.peek();
    const projection = this.state.frame.peek()?.projection;
    if (box === undefined || projection === undefined) return undefined;
    const pose = poseOfCamera(this.#shown?.camera);
    const distanceM = pose?.kind === "orbit" ? pose.distanceM : TYPICAL_DISTANCE_M;
    return { box, projection, distanceM };
  }

  #escape(): boolean {
    const { popover, session } = this.state;
    if (popover.peek() !== undefined) popover.value = undefined;
    else if (session.tool.peek() !== "camera") {
      this.marking.withdrawPointer();
      session.tool.value = "camera";
    } else return false;
    return true;
  }

  #problem(problem: Problem): void {
    this.#newestProblem = problem;
    if (!problem.ownView) this.#ledger.settled(problem.sceneRevision);
    this.state.notify({ subject: "problem", text: problem.message, severity: "problem" });
    // The storm may be gone.
    void this.#storms.learn();
  }

  async #send(scene: Scene, expectedRevision: bigint): Promise<SceneVerdict> {
    const entry = this.#ledger.sent(scene.timeIndex ?? 0, this.#now());
    try {
      const verdict = await this.#client.updateScene(scene, expectedRevision);
      if (verdict.kind === "taken") entry.accepted(verdict.revision);
      else entry.refused();
      return verdict;
    } catch (error) {
      entry.refused();
      throw error;
    }
  }

  #painted(frame: Frame): void {
    const { canvas } = this.#place;
    if (canvas === undefined) return;
    const now = this.#now();
    this.#shown = frame;
    this.#rate.shown(pictureBytes(frame), now);
    this.state.pictureBox.value = this.#place.boxOf(frame);
    this.state.showFrame(frame);
    if (frame.ownView) this.#ownView.placed(frame.camera);
    else {
      this.#ledger.shown(frame.sceneRevision, now);
      this.#adoptCamera();
    }
    const problem = this.#newestProblem;
    if (problem?.ownView === frame.ownView && frame.sceneRevision >= problem.sceneRevision)
      this.state.dismiss("problem");
    const pose = poseOfCamera(frame.camera);
    Object.assign(canvas.dataset, {
      sequence: String(frame.sequence),
      revision: String(frame.sceneRevision),
      refined: String(frame.refined),
      encoding: encodingOf(frame),
      ownView: String(frame.ownView),
      time: String(this.#ledger.shownTimeIndex ?? ""),
      camera: pose?.kind ?? "",
      azimuth: standingAzimuthDeg(pose)?.toFixed(2) ?? "",
      distance: pose?.kind === "orbit" ? pose.distanceM.toFixed(1) : "",
    });
  }

  // Adopts a frame's camera once the frame shows the newest scene.
  #adoptCamera(): void {
    const frame = this.#shown;
    if (frame === undefined || frame.ownView || this.#sync.unsettled) return;
    if (frame.sceneRevision >= this.#sync.revision) this.state.adoptCamera(frame.camera);
  }

  // Such a frame is acknowledged although it is not shown: the server would wait for it.
  #undecodable(frame: Frame): void {
    const text = `Frame ${frame.sequence} is no picture that this browser can read`;
    this.state.notify({ subject: "decode", text, severity: "problem" });
  }

  #windowMessage() {
    const { document, navigator } = this.#window;
    const savesBytes = (navigator as NetworkNavigator | undefined)?.connection?.saveData === true;
    return { ...this.#place.size, hidden: document.hidden, savesBytes };
  }

  #sendWindow(): void {
    this.#client.send({ case: "window", value: this.#windowMessage() });
  }

  #sendOutputSize(): void {
    const { output } = this.state.scene.value;
    const { widthPx, heightPx } = this.#place.size;
    const size = outputSize(widthPx, heightPx, this.state.resolution.value);
    if (!this.#setsOutput || this.state.session.me.value === undefined) return;
    if (output?.widthPx === size.widthPx && output?.heightPx === size.heightPx) return;
    this.state.edit((scene) => withOutput(scene, size));
  }

  // Before this page sends a first scene, the frame shown is of the scene's time.
  #isTimeShown(index: number): boolean {
    if (this.#sync.unsettled || this.#shown === undefined) return false;
    return (this.#ledger.shownTimeIndex ?? index) === index;
  }

  #takePace(): void {
    const now = this.#now();
    // A frame may arrive before the reply that names its revision.
    if (poseOfCamera(this.state.scene.value.camera) === undefined) this.#adoptCamera();
    this.state.pace.value = {
      framesPerSecond: this.#rate.framesPerSecond(now),
      bytesPerSecond: this.#rate.bytesPerSecond(now),
      latencyMs: this.#ledger.latencyMs,
    };
  }

  // Shows a notice that disappears by itself.
  #note(subject: string, text: string): void {
    this.state.notify({ subject, text, severity: "note" });
    const timer = setTimeout(() => this.state.dismiss(subject), NOTE_MS);
    this.#disposals.push(() => clearTimeout(timer));
  }
}

function presenterSteers(presence: Presence): boolean {
  const steerer = presence.people.find(({ viewerId }) => viewerId === presence.steeringViewerId);
  return steerer?.role === Role.PRESENTER;
}

// Browsers may deny storage altogether.
function storageOf(window: Window): Storage | undefined {
  try {
    return window.localStorage;
  } catch {
    return undefined;
  }
}

function rayMessage({ originM, direction }: WorldRay) {
  const [xM, yM, zM] = originM;
  const [x, y, z] = direction;
  return { origin: { xM, yM, zM }, direction: { x, y, z } };
}
