// The comparison of A, the session's picture, with B, a second picture. This class holds the choice
// of what B shows, runs B's session during the comparison, and updates B's scene when A's scene
// changes.
import { ConnectError } from "@connectrpc/connect";
import { computed, effect, signal, untracked } from "@preact/signals-core";
import { cameraOfPose, type Pose, poseOfCamera } from "../../core/camera";
import { type ComparisonChoice, comparedScene, type TimeOfB, timeOfB } from "../../core/comparison";
import { isSameDomain } from "../../core/domain";
import type { PictureTool } from "../../core/marking";
import type { Later } from "../../core/newest";
import { picturePointAt, placeInBox } from "../../core/picture_box";
import { type PicturePoint, projectionOf } from "../../core/projection";
import type { PageState } from "../../core/state";
import type { StrokePoint } from "../../core/stroke";
import type { Frame } from "../../gen/thunderhead/v1/frame_pb";
import type { Scene } from "../../gen/thunderhead/v1/scene_pb";
import type { StormDescription } from "../../gen/thunderhead/v1/storm_pb";
import type { ServerCalls } from "../../transport/server_calls";
import type { OpenInteract } from "../../transport/session_client";
import { boxOnCanvas, pixelsOf } from "../canvas_box";
import type { CanvasPainter } from "../canvas_painter";
import { attachPointer } from "../pointer";
import type { SeenPicture } from "../probing";
import { ComparedSession } from "./compared_session";

// The area in which marks are shown: the left part of the window, as a fraction of its width, or
// the picture's own rectangle.
export type MarkedView = number | "picture";

export interface ComparingSteps {
  move(motion: (pose: Pose) => Pose): void;
  // Returns the active tool, which expects positions over A.
  tool(): PictureTool | undefined;
  // clicked() and doubleClicked() report a click or a double click on B.
  clicked(point: PicturePoint, picture: SeenPicture): void;
  doubleClicked(point: PicturePoint, picture: SeenPicture): void;
  // Reports that B will show something else.
  changed(): void;
  onNextPaint(callback: () => void): () => void;
  later: Later;
}

export class Comparing {
  // The choice of what picture B shows; undefined while no comparison is shown.
  readonly choice = signal<ComparisonChoice | undefined>(undefined);
  readonly frame = signal<Frame | undefined>(undefined);
  // A text about a part of the scene that B cannot show.
  readonly problem = signal<string | undefined>(undefined);
  // Why no picture of B arrives; undefined if pictures arrive.
  readonly interrupted = signal<string | undefined>(undefined);
  // The fraction of the window's width that shows A, in the layout in which a handle swipes one
  // picture over the other.
  readonly swipe = signal(0.5);
  // The description of B's storm, if B shows another storm.
  readonly other = signal<StormDescription | undefined>(undefined);
  // Why the server could not describe B's storm; undefined if it could.
  readonly undescribed = signal<string | undefined>(undefined);
  readonly time = computed((): TimeOfB => {
    const [scene, choice] = [this.#state.scene.value, this.choice.value];
    if (choice === undefined) return { index: scene.timeIndex ?? 0, awayS: 0 };
    return timeOfB(scene, choice, { storm: this.#state.storm.value, other: this.other.value });
  });
  // The area in which marks and pointers are shown. Marks and pointers have positions in A's
  // domain, and B may show a storm of another domain. In the side-by-side layout they are shown
  // only in A.
  readonly markedView = computed((): MarkedView => {
    if (this.choice.value?.layout === "side") return "picture";
    return this.#isOfADomain.value ? 1 : this.swipe.value;
  });
  readonly #isOfADomain = computed(() => {
    const stormId = this.choice.value?.stormId;
    return stormId === undefined || isSameDomain(this.#state.storm.value, this.other.value);
  });
  readonly #calls: ServerCalls;
  readonly #openInteract: OpenInteract;
  readonly #state: PageState;
  readonly #steps: ComparingSteps;
  readonly #size = signal({ widthPx: 0, heightPx: 0 });
  readonly #stop: (() => void)[];
  #session: ComparedSession | undefined;
  #canvas: HTMLCanvasElement | undefined;

  constructor(
    calls: ServerCalls,
    openInteract: OpenInteract,
    state: PageState,
    steps: ComparingSteps,
  ) {
    this.#calls = calls;
    this.#openInteract = openInteract;
    this.#state = state;
    this.#steps = steps;
    this.#stop = [
      effect(() => {
        const scene = this.#wanted();
        untracked(() => this.#show(scene));
      }),
      effect(() => {
        const stormId = this.choice.value?.stormId;
        untracked(() => {
          this.other.value = undefined;
          this.undescribed.value = undefined;
          void this.#describe(stormId);
        });
      }),
      // This effect requests the description of B's storm again when the list of storms changes,
      // because the storm may have new times.
      effect(() => {
        void this.#state.storms.value;
        untracked(() => void this.#describe(this.choice.peek()?.stormId));
      }),
      effect(() => {
        void [this.choice.value?.stormId, this.choice.value?.timeIndex];
        untracked(() => this.#steps.changed());
      }),
    ];
  }

  // Begins a comparison, or changes what is compared.
  change(part: Partial<ComparisonChoice>): void {
    const first: ComparisonChoice = {
      stormId: undefined,
      timeIndex: undefined,
      settings: undefined,
      layout: "swipe",
    };
    this.choice.value = { ...(this.choice.peek() ?? first), ...part };
  }

  end(): void {
    this.choice.value = undefined;
  }

  // Reports that the window was hidden, became visible, or is still visible.
  sendWindow(): void {
    this.#session?.sendWindow();
  }

  // Paints B on this canvas from now on. Returns the function that detaches it.
  attach(canvas: HTMLCanvasElement): () => void {
    this.#canvas = canvas;
    let painter: CanvasPainter | undefined = this.#session?.attach(canvas);
    const detachPointer = attachPointer(canvas, {
      move: (motion) => this.#steps.move(motion),
      tool: () => this.#toolOverA(),
      clicked: (place) => this.#onB(place, (point, seen) => this.#steps.clicked(point, seen)),
      doubleClicked: (place) =>
        this.#onB(place, (point, seen) => this.#steps.doubleClicked(point, seen)),
    });
    const measure = () => {
      const size = pixelsOf(canvas, window.devicePixelRatio);
      painter?.resize(size.widthPx, size.heightPx);
      this.#size.value = size;
      painter ??= this.#session?.attach(canvas);
      this.#session?.resized(size);
    };
    const observer = new ResizeObserver(measure);
    observer.observe(canvas);
    measure();
    return () => {
      observer.disconnect();
      detachPointer();
      this.#session?.detach();
      this.#canvas = undefined;
      this.#size.value = { widthPx: 0, heightPx: 0 };
    };
  }

  dispose(): void {
    for (const stop of this.#stop) stop();
    this.#session?.dispose();
    this.#session = undefined;
  }

  // Returns B's scene. Returns undefined without a comparison, and while the canvas's size, A's
  // camera or B's storm is not known yet.
  #wanted(): Scene | undefined {
    const choice = this.choice.value;
    const size = this.#size.value;
    const pose = this.#state.viewPose.value;
    if (choice === undefined || size.widthPx === 0 || pose === undefined) return undefined;
    // Without the description of B's storm, the time that corresponds to A's time is unknown.
    const described = this.other.value !== undefined || this.undescribed.value !== undefined;
    if (choice.stormId !== undefined && !described) return undefined;
    return comparedScene(this.#state.scene.value, choice, {
      camera: cameraOfPose(pose),
      size,
      storm: this.#state.storm.value,
      other: this.other.value,
    });
  }

  // Returns a tool that moves strokes and pointer positions on B to the same positions on A,
  // because other people see only A.
  #toolOverA(): PictureTool | undefined {
    const tool = this.#steps.tool();
    // If B's storm has another domain, places of B do not correspond to places of A.
    if (tool === undefined || !this.#isOfADomain.peek()) return undefined;
    const overA = (use: (place: StrokePoint) => void) => (place: StrokePoint) => {
      const [point, box] = [this.#pointAt(place), this.#state.pictureBox.peek()];
      if (point !== undefined && box !== undefined) use(placeInBox(box, point));
    };
    return {
      hover: overA((place) => tool.hover(place)),
      press: overA((place) => tool.press(place)),
      drag: overA((place) => tool.drag(place)),
      release: () => tool.release(),
      cancel: () => tool.cancel(),
      leave: () => tool.leave(),
    };
  }

  #onB(place: StrokePoint, use: (point: PicturePoint, picture: SeenPicture) => void): void {
    const point = this.#pointAt(place);
    const frame = this.frame.peek();
    const scene = this.#session?.scene;
    const projection = frame === undefined ? undefined : projectionOf(frame.view);
    if (point === undefined || scene === undefined || projection === undefined) return;
    use(point, { name: "B", scene, pose: poseOfCamera(scene.camera), projection });
  }

  // Returns the point of B's picture at a place of the window.
  #pointAt({ left, top }: StrokePoint): PicturePoint | undefined {
    const [canvas, frame] = [this.#canvas, this.frame.peek()];
    if (canvas === undefined || frame === undefined) return undefined;
    return picturePointAt(boxOnCanvas(canvas, frame), left, top);
  }

  #show(scene: Scene | undefined): void {
    if (scene === undefined) {
      if (this.choice.peek() !== undefined) return;
      this.#session?.dispose();
      this.#session = undefined;
      this.frame.value = undefined;
      this.problem.value = undefined;
      this.interrupted.value = undefined;
      return;
    }
    if (this.#session !== undefined) {
      this.#session.show(scene);
      return;
    }
    this.#session = new ComparedSession(this.#calls, this.#openInteract, {
      painted: (frame) => {
        this.frame.value = frame;
        this.#tell({
          revision: String(frame.sceneRevision),
          refined: String(frame.refined),
          size: `${frame.widthPx}x${frame.heightPx}`,
          scale: String(frame.accuracy?.imageScale ?? 1),
        });
      },
      agreed: (revision) => this.#tell({ agreed: String(revision ?? "") }),
      problem: (text) => {
        this.problem.value = text;
      },
      interrupted: (reason) => {
        this.interrupted.value = reason;
      },
      onNextPaint: (callback) => this.#steps.onNextPaint(callback),
      later: this.#steps.later,
    });
    const { widthPx, heightPx } = this.#size.peek();
    if (this.#canvas !== undefined) this.#session.attach(this.#canvas).resize(widthPx, heightPx);
    this.#session.resized({ widthPx, heightPx });
    this.#session.start(scene);
  }

  // Publishes for tests what B's canvas shows.
  #tell(data: Record<string, string>): void {
    if (this.#canvas !== undefined) Object.assign(this.#canvas.dataset, data);
  }

  async #describe(stormId: string | undefined): Promise<void> {
    if (stormId === undefined) return;
    try {
      const described = await this.#calls.describeStorm(stormId, 0);
      if (this.choice.peek()?.stormId !== stormId) return;
      this.other.value = described;
      this.undescribed.value = undefined;
    } catch (error) {
      // If an older description of the storm exists, it is kept, and the error is not shown.
      if (this.choice.peek()?.stormId !== stormId || this.other.peek() !== undefined) return;
      const why = error instanceof ConnectError ? error.rawMessage : String(error);
      this.undescribed.value = `The times of B are not known: ${why}`;
    }
  }
}
