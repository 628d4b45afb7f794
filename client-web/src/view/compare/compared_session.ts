// The session of B, the second picture of a comparison. It is a session that only this page uses,
// and its scene follows the scene of A, the page's first picture. The session is closed when the
// comparison ends.
import { create } from "@bufbuild/protobuf";
import type { Later } from "../../core/newest";
import { SceneSync } from "../../core/scene_sync";
import type { Connection } from "../../core/state";
import type { Frame } from "../../gen/thunderhead/v1/frame_pb";
import { Codec, type InteractResponse, type Joined } from "../../gen/thunderhead/v1/interact_pb";
import { type Scene, SceneSchema } from "../../gen/thunderhead/v1/scene_pb";
import type { ServerCalls } from "../../transport/server_calls";
import {
  type JoinDetails,
  type OpenedSession,
  type OpenInteract,
  type Refusal,
  SessionClient,
  type SessionListener,
} from "../../transport/session_client";
import type { CanvasPainter } from "../canvas_painter";
import { PictureFlow } from "../picture_flow";

export interface ComparedSteps {
  painted(frame: Frame): void;
  // Reports the value of SceneSync.agreed for B's session.
  agreed(revision: bigint | undefined): void;
  // Reports a part of the scene that B cannot show; undefined if B shows everything.
  problem(text: string | undefined): void;
  // Reports why nothing arrives from B's session; undefined once the session exists.
  interrupted(reason: string | undefined): void;
  onNextPaint(callback: () => void): () => void;
  later: Later;
}

export class ComparedSession implements SessionListener {
  readonly #calls: ServerCalls;
  readonly #steps: ComparedSteps;
  readonly #client: SessionClient;
  readonly #flow: PictureFlow;
  readonly #sync: SceneSync;
  #scene: Scene = create(SceneSchema);
  #presenterKey: string | undefined;
  #viewerId = 0n;
  // The revision of the last problem.
  #problemRevision = 0n;
  #sizePx = { widthPx: 1280, heightPx: 720 };

  constructor(calls: ServerCalls, openInteract: OpenInteract, steps: ComparedSteps) {
    this.#calls = calls;
    this.#steps = steps;
    this.#client = new SessionClient(calls, openInteract, this);
    this.#flow = new PictureFlow({
      acknowledge: (sequence, ownView, lost) => this.#client.acknowledge(sequence, ownView, lost),
      wantsOwnView: () => false,
      painted: (frame) => this.#painted(frame),
      undecodable: () =>
        steps.problem(
          "This browser cannot decode a picture of B. If it happens again, reload the page.",
        ),
      onNextPaint: (callback) => steps.onNextPaint(callback),
    });
    this.#sync = new SceneSync({
      scene: () => this.#scene,
      adopt: (scene) => {
        this.#scene = scene;
      },
      complete: () => undefined,
      changedByOthers: () => undefined,
      send: (scene, revision) => this.#client.updateScene(scene, revision),
      taken: () => steps.problem(undefined),
      agreed: (revision) => steps.agreed(revision),
      refused: (text) => steps.problem(text),
      onNextPaint: (callback) => steps.onNextPaint(callback),
      later: steps.later,
    });
  }

  get scene(): Scene {
    return this.#scene;
  }

  // Opens the session with this scene.
  start(scene: Scene): void {
    this.#scene = scene;
    void this.#client.run();
  }

  attach(canvas: HTMLCanvasElement): CanvasPainter {
    return this.#flow.attach(canvas);
  }

  detach(): void {
    this.#flow.detach();
  }

  show(scene: Scene): void {
    this.#scene = scene;
    this.#sync.edited(() => scene);
  }

  resized(sizePx: { readonly widthPx: number; readonly heightPx: number }): void {
    this.#sizePx = sizePx;
    this.sendWindow();
  }

  // Reports the window to the server, which sends no pictures to a hidden page.
  sendWindow(): void {
    this.#client.send({ case: "window", value: this.#window() });
  }

  dispose(): void {
    this.#sync.dispose();
    this.#client.dispose();
    this.#flow.dispose();
    if (this.#presenterKey !== undefined)
      void this.#calls.closeSession(this.#presenterKey).catch(() => undefined);
  }

  // The methods of SessionListener follow.

  sceneToOpen(): Scene {
    this.#sync.opening();
    return this.#scene;
  }

  openingRefused(message: string): void {
    this.#steps.problem(message);
  }

  opened(opened: OpenedSession): void {
    this.#presenterKey = opened.presenterKey;
    this.#sync.opened(opened.completed, opened.revision);
  }

  joining(): JoinDetails {
    return { name: "", window: this.#window(), codecs: [Codec.JPEG] };
  }

  joined(joined: Joined): void {
    this.#viewerId = joined.viewerId;
    this.#sync.forget();
    this.#flow.startCall();
  }

  connection(connection: Connection): void {
    if (connection.kind !== "live") this.#sync.hold();
    this.#steps.interrupted("reason" in connection ? connection.reason : undefined);
  }

  message(message: InteractResponse["message"]): void {
    switch (message.case) {
      case "scene":
        if (message.value.scene !== undefined)
          this.#sync.told(message.value.scene, message.value.sceneRevision);
        break;
      case "frame":
        this.#flow.offer(message.value);
        break;
      case "problem":
        this.#problemRevision = message.value.sceneRevision;
        this.#steps.problem(message.value.message);
        break;
      case "presence":
        if (message.value.steeringViewerId === this.#viewerId) this.#sync.allow();
        else this.#client.send({ case: "takeControl", value: {} });
        break;
    }
  }

  refused({ subject, message }: Refusal): void {
    // The refusal of an acknowledgement does not matter.
    if (subject !== "acknowledge") this.#steps.problem(message);
  }

  // Returns true to open another session.
  gone(): boolean {
    this.#presenterKey = undefined;
    return true;
  }

  // Clears the problem if the picture on the screen is not older than the problem.
  #painted(frame: Frame): void {
    if (frame.sceneRevision >= this.#problemRevision) this.#steps.problem(undefined);
    this.#steps.painted(frame);
  }

  #window() {
    return { ...this.#sizePx, hidden: document.hidden };
  }
}
