// Test support: a fake of Thunderhead's service in memory, with sessions, revisions, acknowledged frames, a coarse frame
// for each scene and a refined one after a rest; tests can make it fail.
import { create } from "@bufbuild/protobuf";
import { Code, ConnectError, type ConnectRouter } from "@connectrpc/connect";
import { cameraOfPose, poseOfCamera } from "../src/core/camera";
import { LIMITS, withCamera, withOutput } from "../src/core/scene";
import { Stage } from "../src/gen/thunderhead/v1/frame_pb";
import {
  FieldParametersSchema,
  Hydrometeor,
  PhaseFunction_Kind as Kind,
  type Scene,
  SceneSchema,
} from "../src/gen/thunderhead/v1/scene_pb";
import {
  FieldDescription_SizeOrigin,
  StormDescriptionSchema,
} from "../src/gen/thunderhead/v1/storm_pb";
import {
  type AcknowledgeFrameRequest,
  ThunderheadService,
  type WatchFramesResponse,
  WatchFramesResponseSchema,
} from "../src/gen/thunderhead/v1/thunderhead_pb";
import {
  completeRendering,
  FAKE_PRESETS,
  FAKE_TECHNIQUES,
  modelledOf,
  tracesLight,
} from "./fake_techniques";

const REFINE_AFTER_MS = 120;
const TRACE_EVERY_MS = 1000;
const PATHS_A_TRACE = 100_000n;
const MOST_PATHS = 1_000_000n;
const MOST_IN_FLIGHT = 2;

interface Viewer {
  id: bigint;
  sent: bigint[];
  waiting: WatchFramesResponse | undefined;
  wake: (() => void) | undefined;
}

class Session {
  revision = 1n;
  sequence = 0n;
  newest: WatchFramesResponse | undefined;
  readonly viewers = new Map<bigint, Viewer>();
  ended = false;
  refine: ReturnType<typeof setTimeout> | undefined;
  constructor(
    readonly id: string,
    public scene: Scene,
  ) {}
}

export type Draw = (scene: Scene, widthPx: number, heightPx: number) => Uint8Array;

export class FakeService {
  readonly sessions = new Map<string, Session>();
  readonly acknowledged: AcknowledgeFrameRequest[] = [];
  scenesTaken = 0;
  mostUnacknowledged = 0;
  #count = 0;
  #viewers = 0n;
  readonly #storms = [
    { id: "supercell", title: "Supercell that is not there", timeCount: 4, deletable: false },
    { id: "single", title: "One time only", timeCount: 1, deletable: false },
  ];

  // With `tracing`, a session at rest sends frames with ever more traced paths; without, it sends nothing.
  constructor(
    readonly draw: Draw,
    readonly tracing = false,
  ) {}

  readonly routes = (router: ConnectRouter): void => {
    router.service(ThunderheadService, {
      getServerInfo: () => ({
        version: "0.1.0-fake",
        glRenderer: "No renderer: drawn by the fake",
        glVersion: "none",
        device: "software",
        maxSessions: 16,
        techniques: FAKE_TECHNIQUES,
        presets: FAKE_PRESETS,
      }),
      listStorms: () => ({ storms: this.#storms }),
      generateCloud: ({ seed }) => {
        const id = `cloud-${seed ?? 1}`;
        const storm = { id, title: "A cloud made up", timeCount: 1, deletable: true };
        this.#storms.push(storm);
        return { storm };
      },
      deleteCloud: ({ stormId }) => {
        const at = this.#storms.findIndex((storm) => storm.id === stormId);
        if (this.#storms[at]?.deletable !== true) {
          throw new ConnectError(`'${stormId}' was not made here`, Code.FailedPrecondition);
        }
        this.#storms.splice(at, 1);
        return {};
      },
      describeStorm: ({ stormId, timeIndex }) => ({ storm: describe(stormId, timeIndex) }),
      createSession: ({ scene }) => {
        const session = new Session(
          `fake-${++this.#count}-${process.pid}`,
          complete(scene ?? create(SceneSchema)),
        );
        this.sessions.set(session.id, session);
        this.#render(session);
        return { sessionId: session.id, scene: session.scene, sceneRevision: session.revision };
      },
      updateScene: ({ sessionId, scene }) => {
        const session = this.#find(sessionId);
        const exposure = scene?.display?.exposureEv ?? 0;
        if (Math.abs(exposure) > 20) {
          throw new ConnectError(`display.exposure_ev is ${exposure}`, Code.InvalidArgument);
        }
        session.scene = complete(scene ?? create(SceneSchema));
        session.revision += 1n;
        this.scenesTaken += 1;
        this.#render(session);
        return { sceneRevision: session.revision };
      },
      watchFrames: ({ sessionId }, context) => this.#watch(this.#find(sessionId), context.signal),
      acknowledgeFrame: (request) => {
        const session = this.#find(request.sessionId);
        const viewer = session.viewers.get(request.viewerId);
        if (viewer === undefined) throw new ConnectError("no such viewer", Code.NotFound);
        this.acknowledged.push(request);
        viewer.sent = viewer.sent.filter((sequence) => sequence > request.sequence);
        viewer.wake?.();
        return {};
      },
      closeSession: ({ sessionId }) => {
        this.end(sessionId);
        return {};
      },
      renderImage: () => {
        throw new ConnectError("the fake renders no files", Code.Unimplemented);
      },
    });
  };

  // Forgets a session as a restarted server would.
  end(sessionId: string): void {
    const session = this.#find(sessionId);
    session.ended = true;
    clearTimeout(session.refine);
    this.sessions.delete(sessionId);
    for (const viewer of session.viewers.values()) viewer.wake?.();
  }

  #find(sessionId: string): Session {
    const session = this.sessions.get(sessionId);
    if (session === undefined) throw new ConnectError(`no session "${sessionId}"`, Code.NotFound);
    return session;
  }

  #render(session: Session): void {
    clearTimeout(session.refine);
    this.#publish(session, false);
    session.refine = setTimeout(() => this.#rest(session, 0n), REFINE_AFTER_MS);
  }

  // The refined frame, and then frames with ever more traced paths if the scene has traced light.
  #rest(session: Session, tracedPaths: bigint): void {
    this.#publish(session, true, tracedPaths);
    if (!this.tracing || !tracesLight(session.scene) || tracedPaths >= MOST_PATHS) return;
    session.refine = setTimeout(
      () => this.#rest(session, tracedPaths + PATHS_A_TRACE),
      TRACE_EVERY_MS,
    );
  }

  #publish(session: Session, refined: boolean, tracedPaths = 0n): void {
    const share = refined ? 1 : 0.5;
    const widthPx = Math.max(1, Math.round((session.scene.output?.widthPx ?? 640) * share));
    const heightPx = Math.max(1, Math.round((session.scene.output?.heightPx ?? 360) * share));
    const start = performance.now();
    const bytes = this.draw(session.scene, widthPx, heightPx);
    session.sequence += 1n;
    session.newest = create(WatchFramesResponseSchema, {
      event: {
        case: "frame",
        value: {
          sequence: session.sequence,
          sceneRevision: session.revision,
          jpeg: bytes,
          widthPx,
          heightPx,
          camera: session.scene.camera,
          stages: [
            { stage: Stage.VIEW, milliseconds: performance.now() - start },
            { stage: Stage.TONE, milliseconds: 0.1 },
          ],
          modelled: { ...modelledOf(session.scene), tracedPaths },
          refined,
        },
      },
    });
    for (const viewer of session.viewers.values()) {
      viewer.waiting = session.newest;
      viewer.wake?.();
    }
  }

  async *#watch(session: Session, signal: AbortSignal): AsyncGenerator<WatchFramesResponse> {
    this.#viewers += 1n;
    const viewer: Viewer = {
      id: this.#viewers,
      sent: [],
      waiting: session.newest,
      wake: undefined,
    };
    let told = 0n;
    session.viewers.set(viewer.id, viewer);
    const wake = () => viewer.wake?.();
    signal.addEventListener("abort", wake);
    try {
      while (!signal.aborted && !session.ended) {
        const { waiting } = viewer;
        if (waiting?.event.case === "frame" && viewer.sent.length < MOST_IN_FLIGHT) {
          viewer.waiting = undefined;
          viewer.sent.push(waiting.event.value.sequence);
          this.mostUnacknowledged = Math.max(this.mostUnacknowledged, viewer.sent.length);
          const news = session.revision > told;
          told = session.revision;
          const scene = news ? session.scene : undefined;
          yield { ...waiting, viewerId: viewer.id, scene, sceneRevision: news ? told : 0n };
        } else {
          await new Promise<void>((resolve) => {
            viewer.wake = resolve;
          });
        }
      }
    } finally {
      session.viewers.delete(viewer.id);
      signal.removeEventListener("abort", wake);
    }
  }
}

const FIELDS = [
  Hydrometeor.CLOUD,
  Hydrometeor.RAIN,
  Hydrometeor.ICE,
  Hydrometeor.SNOW,
  Hydrometeor.GRAUPEL,
] as const;

const FALSE_COLORS = [
  { red: 1, green: 0, blue: 0 },
  { red: 0, green: 0, blue: 1 },
  { red: 1, green: 0, blue: 1 },
  { red: 1, green: 1, blue: 0 },
  { red: 0, green: 1, blue: 0 },
] as const;

function describe(stormId: string, timeIndex: number) {
  const count = stormId === "supercell" ? 4 : 1;
  return create(StormDescriptionSchema, {
    id: stormId,
    title: stormId,
    timeIndex,
    times: Array.from({ length: count }, (_, index) => ({
      index,
      validTime: `0001-01-01T0${Math.floor((index + 1) / 3)}:${((index + 1) % 3) * 2}0:00Z`,
      elapsedS: index * 1200,
    })),
    fields: FIELDS.map((hydrometeor, i) => ({
      hydrometeor,
      variable: "Q",
      units: "kg kg-1",
      maximum: 4e-3,
      meanWaterPathKgPerM2: 0.8,
      sizeOrigin: FieldDescription_SizeOrigin.SCHEME,
      sizeScheme: "WSM6",
      meanRadiusM: 2e-5 * 10 ** i,
      papersRadiusM: 1e-5 * 10 ** i,
      defaults: create(FieldParametersSchema, {
        hydrometeor,
        visible: true,
        scale: 1,
        densityKgPerM3: 1000,
        albedo: 1,
        phase: { kind: Kind.CORNETTE_SHANKS, asymmetry: 0.85 },
        falseColor: FALSE_COLORS[i],
      }),
    })),
  });
}

// Stands where the whole storm is in view.
const HOME = cameraOfPose({
  kind: "orbit",
  targetM: [4000, 0, 7000],
  azimuthDeg: 200,
  elevationDeg: 8,
  distanceM: 80_000,
  fieldOfViewDeg: 35,
});

function complete(scene: Scene): Scene {
  const stormId = scene.stormId === "" ? "supercell" : scene.stormId;
  const rendering = completeRendering(scene.rendering);
  const camera =
    scene.camera !== undefined && poseOfCamera(scene.camera) !== undefined ? scene.camera : HOME;
  return withOutput(withCamera({ ...scene, stormId, rendering }, camera), {
    widthPx: scene.output?.widthPx ?? LIMITS.width.defaultValue,
    heightPx: scene.output?.heightPx ?? LIMITS.height.defaultValue,
    jpegQuality: scene.output?.jpegQuality ?? LIMITS.jpegQuality.defaultValue,
  });
}
