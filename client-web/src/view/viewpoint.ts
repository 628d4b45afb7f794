// Moves the camera: the session's for who steers, else that of an own view.
import { type CameraKind, homeCamera, type Pose, poseOfCamera } from "../core/camera";
import type { Later } from "../core/newest";
import { OwnView } from "../core/own_view";
import { withCamera } from "../core/scene";
import type { PageState } from "../core/state";
import type { Camera } from "../gen/thunderhead/v1/scene_pb";
import type { SessionClient } from "../transport/session_client";
import type { Notes } from "./notes";

export class Viewpoint {
  readonly #state: PageState;
  readonly #notes: Notes;
  readonly #shownCamera: () => Camera | undefined;
  readonly ownView: OwnView;

  constructor(
    state: PageState,
    client: () => SessionClient,
    notes: Notes,
    shownCamera: () => Camera | undefined,
    later: Later,
  ) {
    this.#state = state;
    this.#notes = notes;
    this.#shownCamera = shownCamera;
    this.ownView = new OwnView(state.session.lookingAround, {
      detach: (camera) => client().send({ case: "detach", value: { camera } }),
      moveCamera: (camera) => client().send({ case: "moveCamera", value: { camera } }),
      follow: () => client().send({ case: "follow", value: {} }),
      later,
    });
  }

  move(motion: (pose: Pose) => Pose): void {
    if (this.#state.session.editBlock.peek() === undefined) this.#state.move(motion);
    else if (this.#startsLookingAround()) this.ownView.move(motion, this.#shownPose());
  }

  // That camera, where absent values are the server's to choose.
  show(camera: Camera): void {
    if (this.#state.session.editBlock.peek() === undefined)
      this.#state.edit((scene) => withCamera(scene, camera));
    else if (this.#startsLookingAround()) this.ownView.show(camera);
  }

  // A camera of that kind that shows the whole storm.
  showKind(kind: CameraKind): void {
    this.show(homeCamera(kind));
  }

  follow(): void {
    this.ownView.follow();
  }

  dispose(): void {
    this.ownView.dispose();
  }

  #startsLookingAround(): boolean {
    const { session, connection } = this.#state;
    if (session.ended.peek() !== undefined || connection.peek().kind !== "live") return false;
    if (session.mayLookAround.peek()) return true;
    this.#notes.say("locked", "The presenter has locked the view: everybody sees the same");
    return false;
  }

  #shownPose(): Pose | undefined {
    return poseOfCamera(this.#shownCamera()) ?? this.#state.pose.peek();
  }
}
