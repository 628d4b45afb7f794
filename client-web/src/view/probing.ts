// Asks the server for the values of the fields along the ray of a click, and keeps the last two
// answers. From two answers the page shows the displacement between the two places.
import { ConnectError } from "@connectrpc/connect";
import { effect, untracked } from "@preact/signals-core";
import { cameraOfPose, type Pose } from "../core/camera";
import { picturePointAt } from "../core/picture_box";
import { type PicturePoint, type Projection, rayAt, type WorldRay } from "../core/projection";
import type { PageState } from "../core/state";
import type { StrokePoint } from "../core/stroke";
import type { ProbeRayResponse } from "../gen/thunderhead/v1/probe_pb";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import type { ServerCalls } from "../transport/server_calls";
import { rayMessage } from "./rays";

// A picture on the screen, and what it shows.
export interface SeenPicture {
  readonly name: "A" | "B";
  readonly scene: Scene;
  readonly pose: Pose | undefined;
  readonly projection: Projection;
}

export class Probing {
  readonly #calls: ServerCalls;
  readonly #state: PageState;
  readonly #stop: () => void;
  #asked = 0;

  constructor(calls: ServerCalls, state: PageState) {
    this.#calls = calls;
    this.#state = state;
    // The answers belong to one storm and time, so they are dropped when another storm or time is
    // shown.
    this.#stop = effect(() => {
      void [state.stormId.value, state.timeIndex.value];
      untracked(() => this.forget());
    });
  }

  dispose(): void {
    this.#stop();
  }

  // Probes the storm at a position in the window, given in CSS pixels.
  async at(place: StrokePoint): Promise<void> {
    const point = this.#pointAt(place);
    if (point !== undefined) await this.through(point);
  }

  // Probes along the ray through a point of the picture.
  async through(point: PicturePoint, picture = this.#pictureA()): Promise<void> {
    if (picture === undefined) return;
    const ray = rayAt(picture.projection, point);
    this.#asked += 1;
    const asked = this.#asked;
    this.#state.probing.value = true;
    try {
      const found = await this.#ask(picture, ray);
      if (asked !== this.#asked) return;
      const probed = { picture: picture.name, stormId: picture.scene.stormId, ray, found };
      this.#state.probes.value = [...this.#state.probes.peek(), probed].slice(-2);
      this.#state.probeProblem.value = undefined;
    } catch (error) {
      if (asked !== this.#asked) return;
      const why = error instanceof ConnectError ? error.rawMessage : String(error);
      this.#state.probeProblem.value = `The probe failed: ${why}`;
    } finally {
      if (asked === this.#asked) this.#state.probing.value = false;
    }
  }

  // Returns the world position of what is seen at a place of the window. The result is undefined
  // for the sky and outside the picture.
  async seenAt(place: StrokePoint): Promise<readonly [number, number, number] | undefined> {
    const point = this.#pointAt(place);
    return point === undefined ? undefined : this.seenThrough(point);
  }

  // Returns the world position of what is seen at a point of the picture.
  async seenThrough(
    point: PicturePoint,
    picture = this.#pictureA(),
  ): Promise<readonly [number, number, number] | undefined> {
    if (picture === undefined) return undefined;
    const { seenPlace } = await this.#ask(picture, rayAt(picture.projection, point), 0);
    const at = seenPlace?.position;
    return at === undefined ? undefined : [at.xM, at.yM, at.zM];
  }

  forget(): void {
    this.#asked += 1;
    this.#state.probes.value = [];
    this.#state.probing.value = false;
    this.#state.probeProblem.value = undefined;
  }

  // Forgets the answers of picture B, because it shows something else now.
  forgetB(): void {
    const left = this.#state.probes.peek().filter(({ picture }) => picture === "A");
    if (left.length < this.#state.probes.peek().length) this.#state.probes.value = left;
  }

  #pointAt({ left, top }: StrokePoint): PicturePoint | undefined {
    const box = this.#state.pictureBox.peek();
    return box === undefined ? undefined : picturePointAt(box, left, top);
  }

  #pictureA(): SeenPicture | undefined {
    const projection = this.#state.frame.peek()?.projection;
    if (projection === undefined) return undefined;
    const pose = this.#state.viewPose.peek();
    return { name: "A", scene: this.#state.scene.peek(), pose, projection };
  }

  #ask({ scene, pose }: SeenPicture, ray: WorldRay, samples?: number): Promise<ProbeRayResponse> {
    return this.#calls.probeRay({
      subject: { case: "scene", value: scene },
      camera: pose === undefined ? undefined : cameraOfPose(pose),
      through: { case: "ray", value: rayMessage(ray) },
      samples,
    });
  }
}
