// The part of the page that shows pictures. It passes frames to the canvas, tracks the canvas's
// size and position in the window, and reports the shown frame to the state.
import { poseOfCamera, standingAzimuthDeg } from "../core/camera";
import { encodingOf, pictureBytes } from "../core/encoding";
import { FrameRate } from "../core/frame_rate";
import type { MarkedPicture, PictureTool } from "../core/marking";
import type { RevisionLedger } from "../core/revision_ledger";
import type { PageState } from "../core/state";
import type { Frame } from "../gen/thunderhead/v1/frame_pb";
import { CanvasPlace } from "./canvas_place";
import { PictureFlow } from "./picture_flow";
import type { PointerSteps } from "./pointer";

// The browser's setting to save data. Not every browser has the property `connection`.
type NetworkNavigator = Navigator & { readonly connection?: { readonly saveData?: boolean } };

const PACE_EVERY_MS = 500;
// Assumed distance to what the camera sees, if the camera has no target.
const TYPICAL_DISTANCE_M = 30_000;

export interface ScreenSteps extends Omit<PointerSteps, "tool"> {
  tool(): PictureTool | undefined;
  acknowledge(sequence: bigint, ownView: boolean, videoLost?: boolean): void;
  // Reports that a frame is on the screen.
  shown(frame: Frame, nowMs: number): void;
  // This callback is called twice a second.
  paced(): void;
  resizeRested(): void;
  onNextPaint(callback: (nowMs: number) => void): () => void;
}

export class Screen {
  readonly #window: Window;
  readonly #state: PageState;
  readonly #ledger: RevisionLedger;
  readonly #steps: ScreenSteps;
  readonly #flow: PictureFlow;
  readonly #place: CanvasPlace;
  readonly #rate = new FrameRate();
  readonly #pace: ReturnType<typeof setInterval>;
  #shown: Frame | undefined;

  constructor(window: Window, state: PageState, ledger: RevisionLedger, steps: ScreenSteps) {
    this.#window = window;
    this.#state = state;
    this.#ledger = ledger;
    this.#steps = steps;
    this.#flow = new PictureFlow({
      acknowledge: (sequence, ownView, lost) => steps.acknowledge(sequence, ownView, lost),
      wantsOwnView: () => state.session.lookingAround.peek(),
      painted: (frame) => this.#painted(frame),
      undecodable: (frame) => this.#undecodable(frame),
      onNextPaint: (callback) => steps.onNextPaint(callback),
    });
    this.#place = new CanvasPlace(window, this.#flow, {
      ...steps,
      resized: () => {
        if (this.#shown !== undefined) state.pictureBox.value = this.#place.boxOf(this.#shown);
      },
    });
    this.#pace = setInterval(() => this.#takePace(), PACE_EVERY_MS);
  }

  get flow(): PictureFlow {
    return this.#flow;
  }

  get canvas(): HTMLCanvasElement | undefined {
    return this.#place.canvas;
  }

  get shown(): Frame | undefined {
    return this.#shown;
  }

  // Returns the canvas's size in physical pixels.
  get size(): { readonly widthPx: number; readonly heightPx: number } {
    return this.#place.size;
  }

  attach(canvas: HTMLCanvasElement): () => void {
    return this.#place.attach(canvas);
  }

  // Returns the message about this page's window (its size and visibility) for the session.
  window() {
    const { document, navigator } = this.#window;
    const savesBytes = (navigator as NetworkNavigator | undefined)?.connection?.saveData === true;
    return { ...this.size, hidden: document.hidden, savesBytes };
  }

  // Returns the picture on which marks are drawn.
  markedPicture(): MarkedPicture | undefined {
    const box = this.#state.pictureBox.peek();
    const projection = this.#state.frame.peek()?.projection;
    if (box === undefined || projection === undefined) return undefined;
    const pose = poseOfCamera(this.#shown?.camera);
    const distanceM = pose?.kind === "orbit" ? pose.distanceM : TYPICAL_DISTANCE_M;
    return { box, projection, distanceM };
  }

  // Publishes, for tests, the scene revision on which page and server agree (SceneSync.agreed). The
  // final picture will show this revision. The text is empty while they do not agree.
  tellAgreed(revision: bigint | undefined): void {
    const { canvas } = this.#place;
    if (canvas !== undefined) canvas.dataset.agreed = String(revision ?? "");
  }

  // Begins a new call to the session. Its frames have new sequence numbers, and the picture on the
  // canvas belongs to an earlier call.
  startCall(): void {
    this.#flow.startCall();
    delete this.#place.canvas?.dataset.revision;
  }

  dispose(): void {
    clearInterval(this.#pace);
    this.#flow.dispose();
  }

  #painted(frame: Frame): void {
    const { canvas } = this.#place;
    if (canvas === undefined) return;
    const now = this.#window.performance.now();
    this.#shown = frame;
    this.#rate.shown(pictureBytes(frame), now);
    this.#state.pictureBox.value = this.#place.boxOf(frame);
    this.#state.showFrame(frame);
    this.#steps.shown(frame, now);
    const { shownTimeIndex } = this.#ledger;
    const pose = poseOfCamera(frame.camera);
    Object.assign(canvas.dataset, {
      sequence: String(frame.sequence),
      revision: String(frame.sceneRevision),
      refined: String(frame.refined),
      encoding: encodingOf(frame),
      size: `${frame.widthPx}x${frame.heightPx}`,
      scale: String(frame.accuracy?.imageScale ?? 1),
      ownView: String(frame.ownView),
      tier: String(frame.tier),
      paths: String(frame.modelled?.tracedPaths ?? 0n),
      time: String(shownTimeIndex ?? ""),
      camera: pose?.kind ?? "",
      azimuth: standingAzimuthDeg(pose)?.toFixed(2) ?? "",
      distance: pose?.kind === "orbit" ? pose.distanceM.toFixed(1) : "",
    });
  }

  // Shows a notice that the frame could not be decoded.
  #undecodable(frame: Frame): void {
    const text = `This browser cannot decode frame ${frame.sequence}. If it happens again, reload the page.`;
    this.#state.notify({ subject: "decode", text, severity: "problem" });
  }

  #takePace(): void {
    const now = this.#window.performance.now();
    this.#steps.paced();
    this.#state.pace.value = {
      framesPerSecond: this.#rate.framesPerSecond(now),
      bytesPerSecond: this.#rate.bytesPerSecond(now),
      latencyMs: this.#ledger.latencyMs,
    };
  }
}
