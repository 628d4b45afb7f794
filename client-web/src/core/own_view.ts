// The view of a person who looks around: its camera, and the messages that begin, move and end it.
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

  // `active` is true while the person looks around.
  constructor(active: Signal<boolean>, steps: OwnViewSteps) {
    this.active = active;
    this.#steps = steps;
    this.#moves = new Newest(MOVE_EVERY_MS, steps.later, (camera) => steps.moveCamera(camera));
  }

  get pose(): Pose | undefined {
    return this.#pose.value;
  }

  // A motion relative to the own pose, or to the pose that is shown when looking around begins.
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

  // Where the server placed a camera that left that open.
  placed(camera: Camera | undefined): void {
    if (this.#pose.peek() === undefined) this.#pose.value = poseOfCamera(camera);
  }

  // The button that ends it.
  follow(): void {
    if (!this.active.peek()) return;
    this.end();
    this.#steps.follow();
  }

  // It has ended, and the server knows.
  end(): void {
    this.#moves.clear();
    this.active.value = false;
    this.#camera = undefined;
    this.#pose.value = undefined;
  }

  // Joined again: the server does not know of it.
  resume(): void {
    if (this.active.peek() && this.#camera !== undefined) this.#steps.detach(this.#camera);
  }

  dispose(): void {
    this.#moves.dispose();
  }
}
