// Moves the camera. If this person steers, the session's camera moves. Otherwise the camera of this
// person's own view moves.
import { create } from "@bufbuild/protobuf";
import { type CameraKind, homeCamera, type Pose, poseOfCamera } from "../core/camera";
import { azimuthTo, standOf } from "../core/map_frame";
import type { Later } from "../core/newest";
import { OwnView } from "../core/own_view";
import { withCamera } from "../core/scene";
import type { PageState } from "../core/state";
import { type Camera, CameraSchema } from "../gen/thunderhead/v1/scene_pb";
import type { SessionClient } from "../transport/session_client";
import type { Notes } from "./notes";

// Assumed height of the target, if the present camera has no target.
const TYPICAL_HEIGHT_M = 5000;

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

  // Shows that camera. The server chooses absent values.
  show(camera: Camera): void {
    if (this.#state.session.editBlock.peek() === undefined)
      this.#state.edit((scene) => withCamera(scene, camera));
    else if (this.#startsLookingAround()) this.ownView.show(camera);
  }

  // Shows the whole storm with a camera of that kind.
  showKind(kind: CameraKind): void {
    this.show(homeCamera(kind));
  }

  // Makes the camera turn around a place in the storm. The camera keeps its azimuth as seen from
  // that place. If it already turns around a target, it also keeps its elevation, distance and
  // angle of view. Otherwise the server chooses them. If `zM` is undefined, the target keeps its
  // present height.
  turnAround([xM, yM, zM]: readonly [number, number, number | undefined]): void {
    const pose = this.#shownPose();
    const orbit = pose?.kind === "orbit" ? pose : undefined;
    const target = { xM, yM, zM: zM ?? orbit?.targetM[2] ?? TYPICAL_HEIGHT_M };
    const stand = standOf(pose);
    const azimuthDeg = stand && azimuthTo([xM, yM], stand.placeM);
    const value = {
      target,
      azimuthDeg,
      elevationDeg: orbit?.elevationDeg,
      distanceM: orbit?.distanceM,
      fieldOfViewDeg: orbit?.fieldOfViewDeg,
    };
    this.show(create(CameraSchema, { kind: { case: "orbit", value } }));
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
    this.#notes.say("locked", "The presenter has locked the view: everyone sees the same");
    return false;
  }

  #shownPose(): Pose | undefined {
    return poseOfCamera(this.#shownCamera()) ?? this.#state.pose.peek();
  }
}
