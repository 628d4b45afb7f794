// Asks the server for the fields along the ray of a click, and keeps the last two answers: the second click measures from the
// first.
import { ConnectError } from "@connectrpc/connect";
import { effect, untracked } from "@preact/signals-core";
import { cameraOfPose } from "../core/camera";
import { picturePointAt } from "../core/picture_box";
import { type PicturePoint, rayAt, type WorldRay } from "../core/projection";
import type { PageState } from "../core/state";
import type { StrokePoint } from "../core/stroke";
import type { ProbeRayResponse } from "../gen/thunderhead/v1/probe_pb";
import type { ServerCalls } from "../transport/server_calls";
import { rayMessage } from "./rays";

export class Probing {
  readonly #calls: ServerCalls;
  readonly #state: PageState;
  readonly #stop: () => void;
  #asked = 0;

  constructor(calls: ServerCalls, state: PageState) {
    this.#calls = calls;
    this.#state = state;
    // Answers belong to the storm and time that were shown, and are dropped with them.
    this.#stop = effect(() => {
      void [state.stormId.value, state.timeIndex.value];
      untracked(() => this.forget());
    });
  }

  dispose(): void {
    this.#stop();
  }

  // Probes at a place of the window, in CSS pixels.
  async at({ left, top }: StrokePoint): Promise<void> {
    const box = this.#state.pictureBox.peek();
    const point = box === undefined ? undefined : picturePointAt(box, left, top);
    if (point !== undefined) await this.through(point);
  }

  // Probes along the ray through a point of the picture.
  async through(point: PicturePoint): Promise<void> {
    const projection = this.#state.frame.peek()?.projection;
    if (projection === undefined) return;
    const ray = rayAt(projection, point);
    this.#asked += 1;
    const asked = this.#asked;
    this.#state.probing.value = true;
    try {
      const found = await this.#ask(ray);
      if (asked !== this.#asked) return;
      this.#state.probes.value = [...this.#state.probes.peek(), { ray, found }].slice(-2);
      this.#state.probeProblem.value = undefined;
    } catch (error) {
      if (asked !== this.#asked) return;
      const why = error instanceof ConnectError ? error.rawMessage : String(error);
      this.#state.probeProblem.value = `The probe failed: ${why}`;
    } finally {
      if (asked === this.#asked) this.#state.probing.value = false;
    }
  }

  // The place of what is seen there; undefined for the sky.
  async seenAt(place: StrokePoint): Promise<readonly [number, number, number] | undefined> {
    const box = this.#state.pictureBox.peek();
    const projection = this.#state.frame.peek()?.projection;
    const point = box === undefined ? undefined : picturePointAt(box, place.left, place.top);
    if (point === undefined || projection === undefined) return undefined;
    const { seenPlace } = await this.#ask(rayAt(projection, point), 0);
    const at = seenPlace?.position;
    return at === undefined ? undefined : [at.xM, at.yM, at.zM];
  }

  forget(): void {
    this.#asked += 1;
    this.#state.probes.value = [];
    this.#state.probing.value = false;
    this.#state.probeProblem.value = undefined;
  }

  #ask(ray: WorldRay, samples?: number): Promise<ProbeRayResponse> {
    const pose = this.#state.viewPose.peek();
    return this.#calls.probeRay({
      subject: { case: "scene", value: this.#state.scene.peek() },
      camera: pose === undefined ? undefined : cameraOfPose(pose),
      through: { case: "ray", value: rayMessage(ray) },
      samples,
    });
  }
}
