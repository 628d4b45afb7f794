// The page's state as signals: the scene being edited, the server's descriptions of itself and its
// storms, the frame on the screen, the connection, and notices. This file does not depend on
// network or document.

import { create } from "@bufbuild/protobuf";
import { batch, computed, type ReadonlySignal, signal } from "@preact/signals-core";
import type {
  AccuracyReport,
  Frame,
  Modelled,
  Refinement,
  StageCost,
} from "../gen/thunderhead/v1/frame_pb";
import type { TimesInMemory } from "../gen/thunderhead/v1/interact_pb";
import type { GetStormMapResponse } from "../gen/thunderhead/v1/probe_pb";
import {
  type Camera,
  type Hydrometeor,
  type Preset,
  type Rendering,
  type Scene,
  SceneSchema,
  type Sun,
  Sun_Source,
} from "../gen/thunderhead/v1/scene_pb";
import type { StormDescription, StormSummary } from "../gen/thunderhead/v1/storm_pb";
import type {
  GetServerInfoResponse,
  TechniqueDescription,
} from "../gen/thunderhead/v1/thunderhead_pb";
import { type AnnotationChoice, FIRST_ANNOTATIONS } from "./annotations";
import { cameraOfPose, type Pose, poseOfCamera } from "./camera";
import { type CloudDraft, FIRST_CLOUD } from "./cloud";
import { hexOfColor } from "./color";
import { domainOf } from "./domain";
import { type Encoding, encodingOf, pictureBytes } from "./encoding";
import { History } from "./history";
import { type Moment, momentOf, secondsBetween } from "./moment";
import type { Box } from "./picture_box";
import type { Probed } from "./probe";
import { type Projection, projectionOf } from "./projection";
import {
  drawsDetail,
  drawsFalseColors,
  presetOf,
  resolved,
  type Settings,
  type SettingsChange,
  settingsOf,
  techniqueNameOf,
  withSettings,
} from "./rendering";
import {
  effectiveField,
  LIMITS,
  withCamera,
  withCompleted,
  withOutput,
  withRendering,
} from "./scene";
import type { Edit } from "./scene_sync";
import { SessionState } from "./session_state";
import { nameOfRun } from "./storm_names";
import type { SunDirection } from "./sun";
import { clockHere } from "./sun_clock";
import type { PanelName, ToolName } from "./tools";
import { formatElapsed } from "./units";
import { describePose, describeSun } from "./words";

export type Connection =
  | { readonly kind: "connecting" }
  | { readonly kind: "live" }
  // `attempts` is the number of attempts to reconnect since the connection was lost. `retryInMs` is
  // the delay before the next attempt.
  | {
      readonly kind: "lost";
      readonly reason: string;
      readonly attempts: number;
      readonly retryInMs: number;
    }
  // The server requires a token, and this page has none or a wrong one.
  | { readonly kind: "locked"; readonly reason: string }
  // The session has ended. SessionState has the reason.
  | { readonly kind: "gone" };

export interface ShownFrame {
  readonly sequence: bigint;
  readonly revision: bigint;
  readonly refined: boolean;
  readonly widthPx: number;
  readonly heightPx: number;
  readonly bytes: number;
  readonly encoding: Encoding;
  readonly stages: readonly StageCost[];
  readonly modelled: Modelled | undefined;
  // Set only for pictures by the reference, the path tracer on the CPU that refines its picture
  // continually.
  readonly refinement: Refinement | undefined;
  readonly accuracy: AccuracyReport | undefined;
  // The level by which the server reduces the picture for this page's network link or window.
  readonly tier: number;
  readonly ownView: boolean;
  readonly pose: Pose | undefined;
  readonly projection: Projection | undefined;
}

export interface Pace {
  readonly framesPerSecond: number;
  readonly bytesPerSecond: number;
  readonly latencyMs: number | undefined;
}

export interface Notice {
  // A newer notice on the same subject replaces an older one.
  readonly subject: string;
  readonly text: string;
  readonly severity: "problem" | "note";
}

const UNKNOWN_COLOR = { red: 0.5, green: 0.5, blue: 0.5 };

export class PageState {
  readonly #scene = signal<Scene>(create(SceneSchema));
  // The camera pose of the frame on the screen. It is used while the scene has no camera values.
  readonly #shownPose = signal<Pose | undefined>(undefined);
  // The sun of the frame on the screen.
  readonly #shownSun = signal<Sun | undefined>(undefined);
  #onEdit: ((edit: Edit) => void) | undefined;

  readonly session = new SessionState();
  readonly history: History;
  readonly connection = signal<Connection>({ kind: "connecting" });
  readonly server = signal<GetServerInfoResponse | undefined>(undefined);
  readonly storms = signal<readonly StormSummary[]>([]);
  readonly storm = signal<StormDescription | undefined>(undefined);
  readonly frame = signal<ShownFrame | undefined>(undefined);
  // The times of the session's storm that are in the server's memory, as last reported.
  readonly timesInMemory = signal<TimesInMemory | undefined>(undefined);
  // The indices of the shown storm's times that are in the server's memory, so that they can be
  // drawn without reading files.
  readonly heldTimes = computed((): readonly number[] => {
    const held = this.timesInMemory.value;
    return held?.stormId === this.stormId.value ? held.timeIndices : [];
  });
  // Why the server sends no video to this browser; undefined if it can send video.
  readonly whyNoVideo = signal<string | undefined>(undefined);
  readonly pace = signal<Pace>({ framesPerSecond: 0, bytesPerSecond: 0, latencyMs: undefined });
  readonly notices = signal<readonly Notice[]>([]);
  // The picture's width divided by the canvas's width, both in device pixels. The ratio of the
  // heights is the same.
  readonly resolution = signal(1);
  // The open tool, and whether it takes the focus because it was opened by a key.
  readonly tool = signal<ToolName | undefined>(undefined);
  toolTakesFocus = false;
  // True while the drawer with every setting is open.
  readonly drawerOpen = signal(false);
  // The open panel of the top bar.
  readonly popover = signal<PanelName | undefined>(undefined);
  // The map, which shows the storm from above, and the reason why the map is missing.
  readonly stormMap = signal<GetStormMapResponse | undefined>(undefined);
  readonly mapProblem = signal<string | undefined>(undefined);
  // The places of the last two clicks with the probe, and the reason if the last one failed.
  readonly probes = signal<readonly Probed[]>([]);
  readonly probing = signal(false);
  readonly probeProblem = signal<string | undefined>(undefined);
  // The annotations over the picture, such as title, scales and rings, each shown or not.
  readonly annotations = signal<AnnotationChoice>(FIRST_ANNOTATIONS);
  // The time zone of the storm's place; undefined for a storm without a place.
  readonly zone = signal<string | undefined>(undefined);
  // The time zone in which the sun's clock is shown.
  readonly sunZone = signal("Etc/GMT");
  // The picture's rectangle in the window, in CSS pixels.
  readonly pictureBox = signal<Box | undefined>(undefined);
  // The cloud as it is set in the panel, and whether the server is making a cloud now.
  readonly cloud = signal<CloudDraft>(FIRST_CLOUD);
  readonly makingCloud = signal(false);

  constructor(nowMs: () => number = Date.now) {
    this.history = new History(nowMs);
  }

  get scene(): ReadonlySignal<Scene> {
    return this.#scene;
  }

  // Parts of the scene. Each signal changes only when its own part changes.
  readonly fields = computed(() => this.#scene.value.fields);
  readonly particleSizes = computed(() => this.#scene.value.particleSizes);
  readonly sun = computed(() => this.#scene.value.sun);
  // The sun's direction as set by hand, or as the server computed it from the clock.
  readonly sunDirection = computed((): SunDirection => {
    const sun = this.#scene.value.sun;
    const byTime = sun?.source === Sun_Source.BY_TIME ? this.#shownSun.value : undefined;
    return {
      azimuthDeg: byTime?.azimuthDeg ?? sun?.azimuthDeg ?? LIMITS.sunAzimuth.defaultValue ?? 0,
      elevationDeg:
        byTime?.elevationDeg ?? sun?.elevationDeg ?? LIMITS.sunElevation.defaultValue ?? 0,
    };
  });
  readonly lights = computed(() => this.#scene.value.lights);
  readonly sky = computed(() => this.#scene.value.sky);
  readonly ground = computed(() => this.#scene.value.ground);
  // The scene's technique and settings, with presets resolved; undefined until the server has sent
  // them.
  readonly rendering = computed(() =>
    resolved(this.#scene.value.rendering, this.server.value?.presets ?? []),
  );
  readonly settings = computed(() => settingsOf(this.rendering.value));
  readonly technique = computed(() => this.#describe(this.settings.value));
  // The preset whose settings equal the scene's rendering settings; undefined if no preset matches,
  // or if the scene has a goal.
  readonly preset = computed((): Preset | undefined =>
    this.goal.value === undefined
      ? presetOf(this.rendering.value, this.server.value?.presets ?? [])
      : undefined,
  );
  readonly display = computed(() => this.#scene.value.display);
  readonly accuracy = computed(() => this.#scene.value.accuracy);
  // The kind of goal, a required accuracy or speed; undefined without a goal. While there is a
  // goal, the server chooses technique and settings.
  readonly goal = computed(() => this.#scene.value.accuracy?.limit.case);
  // The technique that draws the picture: the scene's own technique, or the technique that the
  // server chose for the goal.
  readonly drawnTechnique = computed(() => this.#describe(this.#drawnSettings.value));
  readonly detailShown = computed(() => this.#isDrawn(drawsDetail));
  readonly falseColorsShown = computed(() => this.#isDrawn(drawsFalseColors));
  readonly #drawnSettings = computed(() => {
    const picked = this.goal.value === undefined ? undefined : this.frame.value?.accuracy;
    return settingsOf(picked?.rendering) ?? this.settings.value;
  });
  readonly output = computed(() => this.#scene.value.output);
  // The index of the time that is shown. If the scene has no index, the server shows the storm's last
  // time. The index is then 0 until the storm is listed or described.
  readonly timeIndex = computed(() => this.#scene.value.timeIndex ?? this.#lastTimeIndex.value);
  readonly stormId = computed(() => this.#scene.value.stormId);
  // The description of the storm that is shown; undefined while only the previous storm's
  // description is known.
  readonly #describedStorm = computed(() => {
    const storm = this.storm.value;
    return storm?.id === this.stormId.value ? storm : undefined;
  });
  readonly #lastTimeIndex = computed(() => {
    const listed = this.storms.value.find(({ id }) => id === this.stormId.value);
    const count = this.#describedStorm.value?.times.length ?? listed?.timeCount ?? 0;
    return Math.max(0, count - 1);
  });
  // The domain that is shown; empty until its storm is described.
  readonly domain = computed(() => domainOf(this.#describedStorm.value));
  // The direction of true north in the scene, in degrees clockwise from the grid's north.
  readonly trueNorthDeg = computed(() => this.#describedStorm.value?.trueNorthDeg ?? 0);
  readonly timeCount = computed(() => this.#describedStorm.value?.times.length ?? 0);
  // The camera of the frame on the screen.
  readonly shownCamera = computed(() => {
    const pose = this.frame.value?.pose;
    return pose === undefined ? undefined : cameraOfPose(pose);
  });
  // The camera's pose. If the scene has no camera values, it is the pose of the frame on the
  // screen.
  readonly pose = computed(() => {
    const { camera } = this.#scene.value;
    const shown = this.#shownPose.value;
    const asked = camera?.kind.case;
    return (
      poseOfCamera(camera) ?? (asked === undefined || asked === shown?.kind ? shown : undefined)
    );
  });
  // The pose of the own view while this page looks around, otherwise `pose`.
  readonly viewPose = computed(() => {
    const frame = this.frame.value;
    return this.session.lookingAround.value && frame?.ownView ? frame.pose : this.pose.value;
  });
  readonly cameraKind = computed(
    () => this.#scene.value.camera?.kind.case ?? this.#shownPose.value?.kind ?? "orbit",
  );

  // The title of the picture.
  readonly title = computed(() => {
    const known = this.storms.value.find(({ id }) => id === this.stormId.value);
    return known?.title || this.stormId.value || "Thunderhead";
  });
  // The model run, named by its start.
  readonly run = computed(() => {
    return nameOfRun(this.#describedStorm.value?.runStart ?? "");
  });
  // The reader's assumptions about the storm's files. Each text is one sentence.
  readonly assumptions = computed(() => this.#describedStorm.value?.assumptions ?? []);
  readonly shownTime = computed(() => {
    const count = this.timeCount.value;
    const times = this.#describedStorm.value?.times ?? [];
    return times[Math.min(this.timeIndex.value, count - 1)];
  });
  readonly moment = computed((): Moment | undefined => {
    const time = this.shownTime.value;
    if (time === undefined) return undefined;
    return momentOf(time.validTime, formatElapsed(time.elapsedS), this.zone.value);
  });
  // The sun's clock at the time shown.
  readonly clockHere = computed(() =>
    clockHere(
      this.#scene.value.sun?.clock,
      this.#describedStorm.value?.sunClock,
      this.shownTime.value?.elapsedS ?? 0,
    ),
  );
  // Lead time: seconds since the run's start. If the start is unknown, seconds since the storm's
  // first time.
  readonly leadS = computed(() => {
    const time = this.shownTime.value;
    if (time === undefined) return 0;
    return (
      time.leadS ??
      secondsBetween(this.#describedStorm.value?.runStart ?? "", time.validTime) ??
      time.elapsedS
    );
  });
  // A description of the picture for people who cannot see it.
  readonly description = computed(() => {
    const { date, clock } = this.moment.value ?? { date: "", clock: "" };
    const when = `${date} ${clock}`.trim();
    return [
      `${this.title.value}${when === "" ? "" : `, ${when}`}`,
      describePose(this.viewPose.value, this.trueNorthDeg.value),
      describeSun(this.sunDirection.value, this.trueNorthDeg.value),
    ].join(". ");
  });

  // Returns a field's colour in false colours, charts and tables, as "#rrggbb". It is the scene's
  // colour, or the server's default.
  colorOf(hydrometeor: Hydrometeor): string {
    void this.fields.value;
    const field = this.storm.value?.fields.find((each) => each.hydrometeor === hydrometeor);
    const { falseColor } = effectiveField(this.#scene.peek(), hydrometeor, field?.defaults);
    return hexOfColor(falseColor ?? UNKNOWN_COLOR);
  }

  // Sets the listener. It is called with each edit, recorded or not, after the edit was applied.
  onEdit(listener: (edit: Edit) => void): void {
    this.#onEdit = listener;
  }

  // Applies an edit and sends it to the server. Does nothing while this page cannot change the
  // scene. Use "unrecorded" for an edit that the page makes itself and that undo should not revert.
  edit(change: Edit, record: "recorded" | "unrecorded" = "recorded"): void {
    if (this.session.editBlock.peek() !== undefined) return;
    const before = this.#scene.value;
    const after = change(before);
    if (after === before) return;
    if (record === "recorded") this.history.edited(before, after);
    this.#scene.value = after;
    this.#onEdit?.(change);
  }

  undo(): void {
    const edit = this.#editable() ? this.history.undo() : undefined;
    if (edit !== undefined) this.edit(edit, "unrecorded");
  }

  redo(): void {
    const edit = this.#editable() ? this.history.redo() : undefined;
    if (edit !== undefined) this.edit(edit, "unrecorded");
  }

  // Shows another scene, at this page's size.
  restore(scene: Scene): void {
    this.edit((present) =>
      withOutput(scene, { widthPx: present.output?.widthPx, heightPx: present.output?.heightPx }),
    );
  }

  // Edits the technique. Does nothing until the server has sent the present technique.
  editRendering(change: (rendering: Rendering) => Rendering): void {
    const rendering = this.rendering.peek();
    if (rendering !== undefined) this.edit((scene) => withRendering(scene, change(rendering)));
  }

  // Edits the technique's settings.
  editSettings(change: SettingsChange): void {
    this.editRendering((rendering) => withSettings(rendering, change));
  }

  // Edits the camera relative to its present pose.
  move(motion: (pose: Pose) => Pose): void {
    const pose = this.pose.value;
    if (pose !== undefined) this.edit((scene) => withCamera(scene, cameraOfPose(motion(pose))));
  }

  // Replaces the page's scene by a scene from the server, without sending it back.
  adoptScene(scene: Scene): void {
    const before = this.#scene.peek().stormId;
    if (before !== "" && scene.stormId !== before) this.history.clear();
    this.#scene.value = scene;
  }

  // Fills in the values that the server added to the page's own scene.
  adoptCompleted(scene: Scene): void {
    this.#scene.value = withCompleted(this.#scene.peek(), scene);
  }

  // Reports the camera of the frame on the screen. If the scene's camera has no values, it gets the
  // values of this camera.
  adoptCamera(camera: Camera | undefined): void {
    const pose = poseOfCamera(camera);
    if (pose === undefined) return;
    batch(() => {
      this.#shownPose.value = pose;
      const open = poseOfCamera(this.#scene.value.camera) === undefined;
      if (open) this.#scene.value = withCamera(this.#scene.value, cameraOfPose(pose));
    });
  }

  showFrame(frame: Frame): void {
    this.#shownSun.value = frame.sun;
    this.frame.value = {
      sequence: frame.sequence,
      revision: frame.sceneRevision,
      refined: frame.refined,
      widthPx: frame.widthPx,
      heightPx: frame.heightPx,
      bytes: pictureBytes(frame),
      encoding: encodingOf(frame),
      stages: frame.stages,
      modelled: frame.modelled,
      refinement: frame.refinement,
      accuracy: frame.accuracy,
      tier: frame.tier,
      ownView: frame.ownView,
      pose: poseOfCamera(frame.camera),
      projection: projectionOf(frame.view),
    };
  }

  notify(notice: Notice): void {
    const others = this.notices.value.filter((other) => other.subject !== notice.subject);
    this.notices.value = [...others, notice];
  }

  dismiss(subject: string): void {
    if (!this.notices.value.some((notice) => notice.subject === subject)) return;
    this.notices.value = this.notices.value.filter((notice) => notice.subject !== subject);
  }

  #editable(): boolean {
    return this.session.editBlock.peek() === undefined;
  }

  #describe(settings: Settings | undefined): TechniqueDescription | undefined {
    if (settings === undefined) return undefined;
    const name = techniqueNameOf(settings);
    return this.server.value?.techniques.find((technique) => technique.name === name);
  }

  #isDrawn(draws: (settings: Settings, technique: TechniqueDescription) => boolean): boolean {
    const settings = this.#drawnSettings.value;
    const technique = this.drawnTechnique.value;
    return settings !== undefined && technique !== undefined && draws(settings, technique);
  }
}
