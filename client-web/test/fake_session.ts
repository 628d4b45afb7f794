// Test support: one session of the fake service. It has the scene, the people with their roles and
// control, frames for each person, pointers and marks. It sends a coarse frame for each scene, and
// a refined frame after a rest.
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { type Any, anyPack } from "@bufbuild/protobuf/wkt";
import { Code } from "@connectrpc/connect";
import { ErrorInfoSchema, RetryInfoSchema } from "../src/gen/google/rpc/error_details_pb";
import { type Frame, FrameSchema, Stage } from "../src/gen/thunderhead/v1/frame_pb";
import {
  End_Reason,
  type InteractRequest,
  type InteractResponse,
  InteractResponseSchema,
  type Mark,
  MarkSchema,
  type Ray,
  Role,
  type SessionRules,
  SessionRulesSchema,
} from "../src/gen/thunderhead/v1/interact_pb";
import type { Camera, Position, Scene } from "../src/gen/thunderhead/v1/scene_pb";
import { completeScene, type Draw } from "./fake_scene";
import { modelledOf, tracesLight } from "./fake_techniques";
import { placeMet, viewOfCamera } from "./fake_view";

const REFINE_AFTER_MS = 120;
const TRACE_EVERY_MS = 1000;
const PATHS_A_TRACE = 100_000n;
const MAX_PATHS = 1_000_000n;
const MAX_IN_FLIGHT = 2;
const COLORS = [
  { red: 1, green: 0.75, blue: 0.1 },
  { red: 0.2, green: 0.9, blue: 0.4 },
  { red: 1, green: 0.3, blue: 0.6 },
];

type Outgoing = MessageInitShape<typeof InteractResponseSchema>["message"];

// The frames of one view for one person.
class FrameStream {
  sent: bigint[] = [];
  waiting: Frame | undefined;
  sequence = 0n;
}

export interface FakePerson {
  readonly viewerId: bigint;
  readonly role: Role;
  name: string;
  readonly say: (message: InteractResponse) => void;
  readonly end: (code: Code | 0, message: string) => void;
  hidden: boolean;
  asks: boolean;
  ownCamera: Camera | undefined;
  pointer: Position | undefined;
  readonly shared: FrameStream;
  own: FrameStream;
  readonly heard: InteractRequest[];
}

export class FakeSession {
  revision = 1n;
  scenesTaken = 0;
  mostUnacknowledged = 0;
  rules: SessionRules = create(SessionRulesSchema, {
    viewersMaySteer: false,
    controlLocked: false,
    followingLocked: false,
    viewersMayMark: true,
    freeWhenAway: true,
  });
  readonly people: FakePerson[] = [];
  marks: Mark[] = [];
  // Number of marks to refuse, as if the previous mark was still being placed.
  placing = 0;
  // False while the server does not notice that a connection is lost.
  noticesLosses = true;
  held: { stormId: string; timeIndices: number[] } = { stormId: "", timeIndices: [] };
  #steering: bigint | undefined;
  #presenterSteered = true;
  #sequence = 0n;
  #newest: Frame | undefined;
  #refine: ReturnType<typeof setTimeout> | undefined;
  #lastViewerId = 0n;
  #lastMarkId = 0n;

  constructor(
    readonly presenterKey: string,
    readonly viewerKey: string,
    public scene: Scene,
    readonly draw: Draw,
    readonly tracing: boolean,
  ) {
    this.#render();
  }

  join(
    request: InteractRequest,
    say: FakePerson["say"],
    end: FakePerson["end"],
  ): FakePerson | undefined {
    if (request.message.case !== "join") return undefined;
    const { sessionKey, name, window } = request.message.value;
    const brought = request.message.value.participantKey;
    this.#lastViewerId += 1n;
    const person: FakePerson = {
      viewerId: this.#lastViewerId,
      role: sessionKey === this.presenterKey ? Role.PRESENTER : Role.VIEWER,
      name,
      say,
      end,
      hidden: window?.hidden ?? false,
      asks: false,
      ownCamera: undefined,
      pointer: undefined,
      shared: new FrameStream(),
      own: new FrameStream(),
      heard: [request],
    };
    this.people.push(person);
    if (person.role === Role.PRESENTER && this.#presenterSteered) {
      this.#presenterSteered = false;
      this.#steering = person.viewerId;
    }
    const { viewerId, role } = person;
    const participantKey =
      brought === "" ? `participant-${this.presenterKey}-${viewerId}` : brought;
    this.#tell(person, {
      case: "joined",
      value: { viewerId, role, viewerKey: this.viewerKey, participantKey },
    });
    this.#tell(person, { case: "scene", value: this.#sceneState() });
    this.#tell(person, { case: "marks", value: { marks: this.marks } });
    this.#tell(person, { case: "timesInMemory", value: this.held });
    this.#tellPresence();
    this.#offer(person, this.#newest);
    return person;
  }

  leave(person: FakePerson): void {
    if (!this.noticesLosses) return;
    const at = this.people.indexOf(person);
    if (at < 0) return;
    this.people.splice(at, 1);
    if (this.#steering === person.viewerId) {
      this.#steering = undefined;
      this.#presenterSteered = person.role === Role.PRESENTER;
    }
    this.#tellPresence();
  }

  // Notices the loss of a person's connection. The person who came back inherits control.
  replace(lost: FakePerson, back: FakePerson): void {
    this.people.splice(this.people.indexOf(lost), 1);
    if (this.#steering === lost.viewerId) this.giveControl(back.viewerId);
    else this.#tellPresence();
  }

  // Gives control to a person. 0 means that no person steers.
  giveControl(viewerId: bigint): void {
    this.#presenterSteered = false;
    this.#steering = viewerId === 0n ? undefined : viewerId;
    for (const person of this.people) if (person.viewerId === viewerId) person.asks = false;
    this.#tellPresence();
  }

  // Ends every call, as the server does when it closes the session.
  close(message: string, retryAfterMs?: number): void {
    clearTimeout(this.#refine);
    const reason = retryAfterMs === undefined ? End_Reason.CLOSED : End_Reason.SERVER_STOPS;
    for (const person of this.people.splice(0)) {
      this.#tell(person, { case: "end", value: { reason, message, retryAfterMs } });
      person.end(0, "");
    }
  }

  // Asks all clients to confirm that they are alive.
  checkAlive(): void {
    this.#tellAll({ case: "checkAlive", value: {} });
  }

  receive(person: FakePerson, request: InteractRequest): void {
    person.heard.push(request);
    const { requestId, message } = request;
    const refuse = (code: Code, text: string, details: Any[] = []) =>
      this.#tell(person, {
        case: "refused",
        value: { requestId, status: { code, message: text, details } },
      });
    const presents = person.role === Role.PRESENTER;
    const steers = person.viewerId === this.#steering;
    switch (message.case) {
      case "updateScene":
        if (!steers) refuse(Code.PermissionDenied, "another steers");
        else this.#update(person, requestId, message.value, refuse);
        break;
      case "acknowledge": {
        const stream = message.value.ownView ? person.own : person.shared;
        stream.sent = stream.sent.filter((sequence) => sequence > message.value.sequence);
        this.#pump(person, stream);
        break;
      }
      case "window":
        if (person.hidden !== message.value.hidden) {
          person.hidden = message.value.hidden;
          this.#tellPresence();
          if (!person.hidden) this.#offer(person, this.#newest);
        }
        break;
      case "detach":
        if (this.rules.followingLocked && !presents)
          refuse(Code.PermissionDenied, "following is locked");
        else {
          person.own = new FrameStream();
          this.#showOwn(person, message.value.camera ?? this.scene.camera);
          this.#tellPresence();
        }
        break;
      case "moveCamera":
        if (person.ownCamera === undefined) refuse(Code.FailedPrecondition, "not looking around");
        else this.#showOwn(person, message.value.camera);
        break;
      case "follow":
        this.#follow(person);
        this.#tellPresence();
        break;
      case "point":
        person.pointer = this.#met(person, message.value.ray);
        this.#tellPointers();
        break;
      case "addMark":
        if (!presents && !steers && !this.rules.viewersMayMark)
          refuse(Code.PermissionDenied, "viewers may not draw");
        else if (this.placing > 0) {
          this.placing -= 1;
          refuse(Code.ResourceExhausted, "your last mark is still being placed", tooFast());
        } else this.#addMark(person, message.value.rays);
        break;
      case "eraseMarks":
        this.#eraseMarks(({ viewerId }) => presents || viewerId === person.viewerId);
        break;
      case "askControl":
        if (this.rules.controlLocked) refuse(Code.PermissionDenied, "control is locked");
        else if (this.#steering === undefined && this.rules.viewersMaySteer)
          this.giveControl(person.viewerId);
        else {
          person.asks = true;
          this.#tellPresence();
        }
        break;
      case "giveControl":
        if (steers || presents)
          this.giveControl(message.value.viewerId || this.#whoGetsItBack(presents));
        else refuse(Code.PermissionDenied, "not steering");
        break;
      case "refuseControl":
        for (const other of this.people)
          if (other.viewerId === message.value.viewerId) other.asks = false;
        this.#tellPresence();
        break;
      case "takeControl":
        if (presents) this.giveControl(person.viewerId);
        else refuse(Code.PermissionDenied, "only the presenter takes control");
        break;
      case "setName":
        person.name = message.value.name;
        this.#tellPresence();
        break;
      case "setRules":
        if (presents) this.#setRules(message.value.rules);
        else refuse(Code.PermissionDenied, "only the presenter sets rules");
        break;
    }
  }

  // Changes the scene as a client without Interact would.
  changeScene(scene: Scene): void {
    this.scene = completeScene(scene);
    this.revision += 1n;
    this.scenesTaken += 1;
    this.#tellAll({ case: "scene", value: this.#sceneState() });
    this.#render();
    for (const person of this.people)
      if (person.ownCamera !== undefined) this.#showOwn(person, person.ownCamera);
  }

  #update(
    person: FakePerson,
    requestId: bigint,
    update: { readonly scene?: Scene; readonly expectedRevision?: bigint },
    refuse: (code: Code, text: string) => void,
  ): void {
    const { scene, expectedRevision } = update;
    const exposure = scene?.display?.exposureEv ?? 0;
    if (Math.abs(exposure) > 20) refuse(Code.InvalidArgument, `display.exposure_ev is ${exposure}`);
    else if (expectedRevision !== undefined && expectedRevision !== this.revision)
      refuse(Code.Aborted, `the scene is at revision ${this.revision}`);
    else if (scene !== undefined) {
      this.changeScene(scene);
      this.#tell(person, {
        case: "sceneTaken",
        value: { requestId, sceneRevision: this.revision },
      });
    }
  }

  #setRules(rules: SessionRules | undefined): void {
    const given = Object.entries(rules ?? {}).filter(([, value]) => typeof value === "boolean");
    this.rules = { ...this.rules, ...Object.fromEntries(given) };
    if (this.rules.followingLocked)
      for (const person of this.people) if (person.role === Role.VIEWER) this.#follow(person);
    this.#tellPresence();
  }

  // Returns the person who gets control back. A viewer returns it to the presenter. If the
  // presenter returns it, no one steers.
  #whoGetsItBack(fromPresenter: boolean): bigint {
    const presenter = this.people.find(({ role }) => role === Role.PRESENTER);
    return fromPresenter ? 0n : (presenter?.viewerId ?? 0n);
  }

  #met(person: FakePerson, ray: Ray | undefined): Position | undefined {
    if (ray === undefined) return undefined;
    return {
      $typeName: "thunderhead.v1.Position",
      ...placeMet(ray, person.ownCamera ?? this.scene.camera),
    };
  }

  #addMark(person: FakePerson, rays: readonly Ray[]): void {
    this.#lastMarkId += 1n;
    const { viewerId } = person;
    const mark = create(MarkSchema, {
      markId: this.#lastMarkId,
      viewerId,
      positions: rays.map((ray) => placeMet(ray, person.ownCamera ?? this.scene.camera)),
      color: COLORS[Number(viewerId) % COLORS.length],
    });
    this.marks = [...this.marks, mark];
    this.#tellAll({ case: "marks", value: { marks: [mark], onlyChanges: true } });
  }

  #eraseMarks(erases: (mark: Mark) => boolean): void {
    const erasedMarkIds = this.marks.filter(erases).map(({ markId }) => markId);
    this.marks = this.marks.filter((mark) => !erases(mark));
    this.#tellAll({ case: "marks", value: { erasedMarkIds, onlyChanges: true } });
  }

  #follow(person: FakePerson): void {
    if (person.ownCamera === undefined) return;
    person.ownCamera = undefined;
    this.#offer(person, this.#newest);
  }

  #showOwn(person: FakePerson, camera: Camera | undefined): void {
    person.ownCamera = completeScene({ ...this.scene, camera }).camera;
    person.own.sequence += 1n;
    const scene = { ...this.scene, camera: person.ownCamera };
    person.own.waiting = this.#frameOf(scene, true, 0n, {
      sequence: person.own.sequence,
      ownView: true,
    });
    this.#pump(person, person.own);
  }

  // Keeps the times that were shown in memory, and reads one time ahead.
  #read(): void {
    const { stormId, timeIndex } = this.scene;
    if (this.held.stormId !== stormId) this.held = { stormId, timeIndices: [] };
    const read = [...this.held.timeIndices, timeIndex ?? 0, (timeIndex ?? 0) + 1];
    this.held.timeIndices = [...new Set(read)].sort((a, b) => a - b);
    this.#tellAll({ case: "timesInMemory", value: this.held });
  }

  #render(): void {
    clearTimeout(this.#refine);
    this.#read();
    this.#publish(false);
    this.#refine = setTimeout(() => this.#rest(0n), REFINE_AFTER_MS);
  }

  // Sends the refined frame. If the scene traces paths, then sends frames with more and more of
  // them.
  #rest(tracedPaths: bigint): void {
    this.#publish(true, tracedPaths);
    if (!this.tracing || !tracesLight(this.scene) || tracedPaths >= MAX_PATHS) return;
    this.#refine = setTimeout(() => this.#rest(tracedPaths + PATHS_A_TRACE), TRACE_EVERY_MS);
  }

  #publish(refined: boolean, tracedPaths = 0n): void {
    this.#sequence += 1n;
    const counted = { sequence: this.#sequence, ownView: false };
    this.#newest = this.#frameOf(this.scene, refined, tracedPaths, counted);
    for (const person of this.people) this.#offer(person, this.#newest);
  }

  #frameOf(
    scene: Scene,
    refined: boolean,
    tracedPaths: bigint,
    counted: { readonly sequence: bigint; readonly ownView: boolean },
  ): Frame {
    const share = refined ? 1 : 0.5;
    const widthPx = Math.max(1, Math.round((scene.output?.widthPx ?? 640) * share));
    const heightPx = Math.max(1, Math.round((scene.output?.heightPx ?? 360) * share));
    const start = performance.now();
    const jpeg = this.draw(scene, widthPx, heightPx);
    return create(FrameSchema, {
      ...counted,
      sceneRevision: this.revision,
      jpeg,
      widthPx,
      heightPx,
      camera: scene.camera,
      view: viewOfCamera(scene.camera, widthPx / heightPx),
      stages: [
        { stage: Stage.VIEW, milliseconds: performance.now() - start },
        { stage: Stage.TONE, milliseconds: 0.1 },
      ],
      modelled: { ...modelledOf(scene), tracedPaths },
      refined,
    });
  }

  #offer(person: FakePerson, frame: Frame | undefined): void {
    if (person.ownCamera !== undefined) return;
    person.shared.waiting = frame;
    this.#pump(person, person.shared);
  }

  #pump(person: FakePerson, stream: FrameStream): void {
    const { waiting } = stream;
    if (person.hidden || waiting === undefined || stream.sent.length >= MAX_IN_FLIGHT) return;
    stream.waiting = undefined;
    stream.sent.push(waiting.sequence);
    this.mostUnacknowledged = Math.max(this.mostUnacknowledged, stream.sent.length);
    this.#tell(person, { case: "frame", value: waiting });
  }

  #sceneState() {
    return { scene: this.scene, sceneRevision: this.revision };
  }

  #tellPresence(): void {
    const people = this.people.map(({ viewerId, name, role, ownCamera, hidden, asks }) => ({
      viewerId,
      name,
      role,
      follows: ownCamera === undefined,
      hidden,
      asksControl: asks,
    }));
    this.#tellAll({
      case: "presence",
      value: {
        people,
        steeringViewerId: this.#steering ?? 0n,
        rules: this.rules,
        presenterAway: this.#presenterSteered,
      },
    });
  }

  #tellPointers(): void {
    const pointers = this.people.flatMap(({ viewerId, pointer }) =>
      pointer === undefined ? [] : [{ viewerId, position: pointer }],
    );
    this.#tellAll({ case: "pointers", value: { pointers } });
  }

  catalogueChanged(revision: bigint): void {
    this.#tellAll({ case: "catalogueChanged", value: { revision } });
  }

  #tellAll(message: Outgoing): void {
    for (const person of [...this.people]) this.#tell(person, message);
  }

  #tell(person: FakePerson, message: Outgoing): void {
    person.say(create(InteractResponseSchema, { message }));
  }
}

const tooFast = () => [
  anyPack(ErrorInfoSchema, create(ErrorInfoSchema, { reason: "MARKS_TOO_FAST" })),
  anyPack(RetryInfoSchema, create(RetryInfoSchema, { retryDelay: { nanos: 200_000_000 } })),
];
