// The own view of a person who looks around. This class holds its camera, and sends the messages
// that begin, move and end the view.
import { type Signal, signal } from "@preact/signals-core";
import type { Camera } from "../gen/thunderhead/v1/scene_pb";
import { cameraOfPose, type Pose, poseOfCamera } from "./camera";
import { type Later, Newest } from "./newest";

export interface OwnViewSteps {
  detach(camera: Camera): void;
  moveCamera(camera: Camera): void;
  follow(): void;
  later: Later;
}

const MOVE_EVERY_MS = 33;

export class OwnView {
  readonly active: Signal<boolean>;
  readonly #pose = signal<Pose | undefined>(undefined);
  readonly #steps: OwnViewSteps;
  readonly #moves: Newest<Camera>;
  #camera: Camera | undefined;

  // Makes the view. `active` is true while the person looks around.
  constructor(active: Signal<boolean>, steps: OwnViewSteps) {
    this.active = active;
    this.#steps = steps;
    this.#moves = new Newest(MOVE_EVERY_MS, steps.later, (camera) => steps.moveCamera(camera));
  }

  get pose(): Pose | undefined {
    return this.#pose.value;
  }

  // Moves the own view's camera. If there is no own view yet, begins it at the pose that is shown.
  move(motion: (pose: Pose) => Pose, shown: Pose | undefined): void {
    const from = this.active.peek() ? (this.#pose.peek() ?? shown) : shown;
    if (from !== undefined) this.show(cameraOfPose(motion(from)));
  }

  show(camera: Camera): void {
    this.#camera = camera;
    this.#pose.value = poseOfCamera(camera);
    if (this.active.peek()) {
      this.#moves.offer(camera);
      return;
    }
    this.active.value = true;
    this.#steps.detach(camera);
  }

  // Reports the camera with which a frame was drawn. If the own view's camera has no values, the
  // server has chosen them, and the view takes its pose from this frame.
  placed(camera: Camera | undefined): void {
    if (this.#pose.peek() === undefined) this.#pose.value = poseOfCamera(camera);
  }

  // Ends the view at the person's request, and tells the server.
  follow(): void {
    if (!this.active.peek()) return;
    this.end();
    this.#steps.follow();
  }

  // Ends the view without telling the server, which already knows.
  end(): void {
    this.#moves.clear();
    this.active.value = false;
    this.#camera = undefined;
    this.#pose.value = undefined;
  }

  // Begins the own view again after the page has joined again, because the server has forgotten it.
  resume(): void {
    if (this.active.peek() && this.#camera !== undefined) this.#steps.detach(this.#camera);
  }

  dispose(): void {
    this.#moves.dispose();
  }
}
