// Connects the parts: sends edits to the server, paints frames on the canvas, acknowledges them and measures their
// latency. Owns the parts; dispose() ends them.

import { create } from "@bufbuild/protobuf";
import type { Transport } from "@connectrpc/connect";
import { effect } from "@preact/signals-core";
import { type CameraKind, homeCamera, poseOfCamera, standingAzimuthDeg } from "../core/camera";
import { FramePipeline } from "../core/frame_pipeline";
import { FrameRate } from "../core/frame_rate";
import { Playback } from "../core/playback";
import { RevisionLedger } from "../core/revision_ledger";
import { outputSize, withCamera, withOutput, withStorm, withTime } from "../core/scene";
import { SceneSender } from "../core/scene_sender";
import { PageState } from "../core/state";
import type { Frame, Problem } from "../gen/thunderhead/v1/frame_pb";
import { type Scene, SceneSchema } from "../gen/thunderhead/v1/scene_pb";
import {
  type OpenedSession,
  SessionClient,
  type SessionListener,
} from "../transport/session_client";
import { CanvasPainter } from "./canvas_painter";
import { attachKeyboard } from "./keyboard";
import { linkTo, readLink, withoutLink } from "./link";
import { attachPointer } from "./pointer";
import { StormsOnServer } from "./storms_on_server";

const RESIZE_REST_MS = 150;
const PACE_EVERY_MS = 500;
const NOTE_MS = 6000;
// Narrower windows start with the panel closed.
const NARROW_PX = 700;

export class Page implements SessionListener {
  readonly state = new PageState();
  readonly playback: Playback;
  readonly #window: Window;
  readonly #client: SessionClient;
  readonly #storms: StormsOnServer;
  readonly #sender: SceneSender;
  readonly #pipeline: FramePipeline<Frame, ImageBitmap>;
  readonly #ledger = new RevisionLedger();
  readonly #rate = new FrameRate();
  readonly #listening = new AbortController();
  readonly #disposals: (() => void)[] = [];
  #canvas: HTMLCanvasElement | undefined;
  #painter: CanvasPainter | undefined;
  #canvasSize = { widthPx: 1280, heightPx: 720 };
  // False for a viewer who joined another's session, which keeps its picture size.
  #setsOutput: boolean;
  #shown: Frame | undefined;
  #problemRevision = 0n;
  // The newest scene that the server sent, until it is known whether this page made it.
  #told: { scene: Scene; revision: bigint } | undefined;
  // The newest revision by another viewer that the controls show.
  #adoptedRevision = -1n;
  #running = false;

  constructor(transport: Transport, window: Window) {
    this.#window = window;
    const link = readLink(window.location.href);
    if (link.scene !== undefined) this.state.adoptScene(link.scene);
    this.#setsOutput = link.sessionId === undefined;
    this.state.panelOpen.value = window.innerWidth >= NARROW_PX;

    this.#client = new SessionClient(transport, this, link.sessionId);
    this.#storms = new StormsOnServer(this.#client, this.state);
    const onNextPaint = (callback: (nowMs: number) => void) => {
      const request = window.requestAnimationFrame(callback);
      return () => window.cancelAnimationFrame(request);
    };
    this.#sender = new SceneSender({ send: (scene) => this.#send(scene), onNextPaint });
    this.#pipeline = new FramePipeline({
      decode: (frame) => decodeJpeg(frame.jpeg),
      onNextPaint,
      paint: (frame, picture) => this.#paint(frame, picture),
      release: (picture) => picture.close(),
      failed: (frame) => this.#undecodable(frame),
    });
    this.playback = new Playback({
      timeCount: () => this.state.timeCount.value,
      timeIndex: () => this.state.timeIndex.value,
      isShown: (index) => this.#isTimeShown(index),
      showTime: (index) => this.showTime(index),
      onNextPaint,
    });
    this.state.onEdit((scene) => this.#sender.push(scene));
    this.#listen();
  }

  // Paints pictures on this canvas from now on. Returns the function that detaches it.
  attachCanvas(canvas: HTMLCanvasElement): () => void {
    const painter = new CanvasPainter(canvas);
    this.#canvas = canvas;
    this.#painter = painter;
    const detachPointer = attachPointer(canvas, (motion) => this.state.move(motion));
    let resting: ReturnType<typeof setTimeout> | undefined;
    const measure = () => {
      const ratio = this.#window.devicePixelRatio;
      const widthPx = Math.max(1, Math.round(canvas.clientWidth * ratio));
      const heightPx = Math.max(1, Math.round(canvas.clientHeight * ratio));
      this.#canvasSize = { widthPx, heightPx };
      painter.resize(widthPx, heightPx);
    };
    const observer = new ResizeObserver(() => {
      measure();
      clearTimeout(resting);
      resting = setTimeout(() => this.#sendOutputSize(), RESIZE_REST_MS);
    });
    observer.observe(canvas);
    measure();
    this.#start();
    return () => {
      observer.disconnect();
      clearTimeout(resting);
      detachPointer();
      painter.dispose();
      this.#canvas = undefined;
      this.#painter = undefined;
    };
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
    this.state.edit((scene) => withCamera(scene, homeCamera(kind)));
  }

  home(): void {
    this.showCamera(this.state.cameraKind.value);
  }

  togglePanel(): void {
    this.state.panelOpen.value = !this.state.panelOpen.value;
  }

  setResolution(share: number): void {
    this.state.resolution.value = share;
    this.#setsOutput = true;
    this.#sendOutputSize();
  }

  async copyLink(): Promise<void> {
    const session = this.state.session.value;
    if (session === undefined) return;
    this.state.session.value = { ...session, shared: true };
    const { location, navigator } = this.#window;
    const address = linkTo(location.href, session.id, this.state.scene.value);
    try {
      await navigator.clipboard.writeText(address);
      this.#note("link", "Link copied");
    } catch {
      // Browsers deny the clipboard to pages without HTTPS or without focus.
      this.state.notify({ subject: "link", text: address, severity: "note" });
    }
  }

  dispose(): void {
    this.#storms.dispose();
    this.#listening.abort();
    for (const dispose of this.#disposals) dispose();
    this.playback.dispose();
    this.#sender.stop();
    this.#client.dispose();
    this.#pipeline.dispose();
  }

  // SessionListener.

  sceneToOpen(): Scene {
    this.#setsOutput = true;
    const size = outputSize(
      this.#canvasSize.widthPx,
      this.#canvasSize.heightPx,
      this.state.resolution.value,
    );
    this.state.adoptScene(withOutput(this.state.scene.value, size));
    return this.state.scene.value;
  }

  openingRefused(message: string): void {
    this.state.notify({ subject: "refused", text: message, severity: "problem" });
    this.state.adoptScene(create(SceneSchema));
  }

  opened(session: OpenedSession): void {
    const before = this.state.session.value;
    this.state.session.value = { id: session.id, shared: false };
    this.#ledger.startSession();
    this.#adoptedRevision = -1n;
    this.#told = undefined;
    this.#ledger.sent(session.completed.timeIndex ?? 0, this.#now()).accepted(session.revision);
    if (this.state.scene.value === session.asked) this.state.adoptScene(session.completed);
    this.#sender.start(session.asked);
    // Without this, reloading would look for a session that has ended.
    this.#window.history.replaceState(null, "", withoutLink(this.#window.location.href));
    if (session.replaces) {
      const text =
        before === undefined || before.shared
          ? "The shared session has ended; this is a new one of your own."
          : "The server had lost the session; this is a new one with the same scene.";
      this.#note("session", text);
    }
    void this.#storms.learn();
  }

  streaming(sessionId: string): void {
    this.#pipeline.startStream();
    this.#sender.start();
    if (this.state.session.value?.id !== sessionId) {
      this.state.session.value = { id: sessionId, shared: true };
      void this.#storms.learn();
    }
  }

  connection(connection: PageState["connection"]["value"]): void {
    this.state.connection.value = connection;
    if (connection.kind === "lost") this.#sender.stop();
  }

  scene(scene: Scene, revision: bigint): void {
    this.#told = { scene, revision };
    this.#adoptTold();
  }

  frame(frame: Frame): void {
    this.#pipeline.offer(frame);
  }

  problem(problem: Problem): void {
    this.#problemRevision = problem.sceneRevision;
    this.#ledger.settled(problem.sceneRevision);
    this.state.notify({ subject: "problem", text: problem.message, severity: "problem" });
    // The storm may be gone.
    void this.#storms.learn();
  }

  #start(): void {
    if (this.#running) return;
    this.#running = true;
    void this.#client.run();
  }

  #now(): number {
    return this.#window.performance.now();
  }

  #listen(): void {
    const options = { signal: this.#listening.signal };
    const window = this.#window;
    window.addEventListener("online", () => this.#client.retryNow(), options);
    window.addEventListener("pagehide", (event) => this.#leave(event), options);
    const pace = setInterval(() => this.#takePace(), PACE_EVERY_MS);
    this.#disposals.push(
      () => clearInterval(pace),
      attachKeyboard(window, {
        move: (motion) => this.state.move(motion),
        home: () => this.home(),
        togglePanel: () => this.togglePanel(),
        togglePlay: () => this.playback.toggle(),
        stepTime: (by) => this.playback.step(by),
      }),
      effect(() => this.#storms.describeAfterRest(this.playback.playing.value)),
    );
  }

  // A page that is closed ends its session, unless others may be watching it.
  #leave(event: PageTransitionEvent): void {
    if (!event.persisted && this.state.session.value?.shared === false) this.#client.closeSession();
  }

  async #send(scene: Scene): Promise<void> {
    const entry = this.#ledger.sent(scene.timeIndex ?? 0, this.#now());
    try {
      const verdict = await this.#client.updateScene(scene);
      if (verdict.kind === "taken") {
        entry.accepted(verdict.revision);
        this.state.dismiss("refused");
      } else {
        entry.refused();
        this.state.notify({ subject: "refused", text: verdict.message, severity: "problem" });
      }
    } catch (error) {
      entry.refused();
      throw error;
    }
  }

  #paint(frame: Frame, picture: ImageBitmap): void {
    if (this.#painter === undefined || this.#canvas === undefined) {
      picture.close();
      return;
    }
    this.#painter.paint(picture);
    const now = this.#now();
    this.#shown = frame;
    this.#ledger.shown(frame.sceneRevision, now);
    this.#rate.shown(frame.jpeg.byteLength, now);
    this.#client.acknowledge(frame.sequence);
    this.state.showFrame(frame);
    this.#adoptCamera();
    if (frame.sceneRevision >= this.#problemRevision) this.state.dismiss("problem");
    const pose = poseOfCamera(frame.camera);
    Object.assign(this.#canvas.dataset, {
      sequence: String(frame.sequence),
      revision: String(frame.sceneRevision),
      refined: String(frame.refined),
      time: String(this.#ledger.shownTimeIndex ?? ""),
      camera: pose?.kind ?? "",
      azimuth: standingAzimuthDeg(pose)?.toFixed(2) ?? "",
      distance: pose?.kind === "orbit" ? pose.distanceM.toFixed(1) : "",
    });
  }

  // Once the server has answered every scene sent, another viewer's scene replaces ours; for our own scene, the settings
  // that the server filled in are adopted.
  #adoptTold(): void {
    const told = this.#told;
    if (told === undefined || this.#sender.unsettled) return;
    this.#told = undefined;
    const ours = this.#ledger.newestAccepted;
    if (told.revision === ours) this.state.adoptRendering(told.scene.rendering);
    if (told.revision <= ours) return;
    this.#adoptedRevision = told.revision;
    this.state.adoptScene(told.scene);
  }

  // Adopts a frame's camera once the frame shows the newest scene sent.
  #adoptCamera(): void {
    const frame = this.#shown;
    if (frame === undefined || this.#sender.unsettled) return;
    const ours = this.#ledger.newestAccepted;
    if (frame.sceneRevision < ours || frame.sceneRevision < this.#adoptedRevision) return;
    this.state.adoptCamera(frame.camera, frame.sceneRevision > ours);
  }

  // Acknowledged although not shown: the server would wait for it.
  #undecodable(frame: Frame): void {
    this.#client.acknowledge(frame.sequence);
    const text = `Frame ${frame.sequence} is no picture that this browser can read`;
    this.state.notify({ subject: "decode", text, severity: "problem" });
  }

  #sendOutputSize(): void {
    const { output } = this.state.scene.value;
    const { widthPx, heightPx } = this.#canvasSize;
    const size = outputSize(widthPx, heightPx, this.state.resolution.value);
    if (!this.#setsOutput || this.state.session.value === undefined) return;
    if (output?.widthPx === size.widthPx && output?.heightPx === size.heightPx) return;
    this.state.edit((scene) => withOutput(scene, size));
  }

  // Before this page sends a first scene, the frame shown is of the scene's time.
  #isTimeShown(index: number): boolean {
    if (this.#sender.unsettled || this.#shown === undefined) return false;
    return (this.#ledger.shownTimeIndex ?? index) === index;
  }

  #takePace(): void {
    const now = this.#now();
    // A frame may arrive before the reply that names its revision.
    if (poseOfCamera(this.state.scene.value.camera) === undefined) this.#adoptCamera();
    this.#adoptTold();
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

function decodeJpeg(jpeg: Uint8Array): Promise<ImageBitmap> {
  // Blob does not accept shared buffers; decoded messages never use them.
  const bytes = jpeg as Uint8Array<ArrayBuffer>;
  return createImageBitmap(new Blob([bytes], { type: "image/jpeg" }));
}
