// Functions that change a scene. Scenes are immutable: a change returns a new scene that shares the
// unchanged parts, so `===` detects changes. An absent value stands for its default in
// proto/thunderhead/v1/scene.proto.
import {
  create,
  type DescMessage,
  equals,
  fromBinary,
  type Message,
  type MessageShape,
  toBinary,
} from "@bufbuild/protobuf";
import {
  type Accuracy,
  AccuracySchema,
  type Camera,
  type Detail,
  DetailSchema,
  type DirectionalLight,
  DirectionalLightSchema,
  type Display,
  DisplaySchema,
  type FieldParameters,
  FieldParametersSchema,
  type Ground,
  GroundSchema,
  type Hydrometeor,
  type Output,
  OutputSchema,
  ParticleSizes,
  PhaseFunctionSchema,
  type Preset,
  type Rendering,
  RenderingSchema,
  type Scene,
  SceneSchema,
  type Sky,
  SkySchema,
  type Sun,
  type SunClock,
  SunClockSchema,
  SunSchema,
  type ToneMap,
} from "../gen/thunderhead/v1/scene_pb";
import {
  clampToLimits,
  defaultChoiceOf,
  defaultOnOf,
  type Limits,
  limitsOf,
  mostItemsOf,
} from "./limits";
import { QUALITY_PRESETS, renderingOfPreset } from "./rendering";
import { firstDateTime } from "./sun_clock";

export const LIMITS = {
  fieldScale: limitsOf(FieldParametersSchema.field.scale),
  fieldRadius: limitsOf(FieldParametersSchema.field.radiusM),
  fieldDensity: limitsOf(FieldParametersSchema.field.densityKgPerM3),
  fieldAlbedo: limitsOf(FieldParametersSchema.field.albedo),
  detailShare: limitsOf(DetailSchema.field.share),
  detailWavelength: limitsOf(DetailSchema.field.wavelengthM),
  detailOctaves: limitsOf(DetailSchema.field.octaves),
  detailSeed: limitsOf(DetailSchema.field.seed),
  phaseAsymmetry: limitsOf(PhaseFunctionSchema.field.asymmetry),
  sunAzimuth: limitsOf(SunSchema.field.azimuthDeg),
  sunElevation: limitsOf(SunSchema.field.elevationDeg),
  sunLatitude: limitsOf(SunClockSchema.field.latitudeDeg),
  sunLongitude: limitsOf(SunClockSchema.field.longitudeDeg),
  sunIrradiance: limitsOf(SunSchema.field.irradiance),
  lightAzimuth: limitsOf(DirectionalLightSchema.field.azimuthDeg),
  lightElevation: limitsOf(DirectionalLightSchema.field.elevationDeg),
  lightIrradiance: limitsOf(DirectionalLightSchema.field.irradiance),
  skyBrightness: limitsOf(SkySchema.field.brightness),
  groundAlbedo: limitsOf(SkySchema.field.groundAlbedo),
  turbidity: limitsOf(SkySchema.field.turbidity),
  exposure: limitsOf(DisplaySchema.field.exposureEv),
  width: limitsOf(OutputSchema.field.widthPx),
  height: limitsOf(OutputSchema.field.heightPx),
  jpegQuality: limitsOf(OutputSchema.field.jpegQuality),
  maxError: limitsOf(AccuracySchema.field.maxError),
  maxMilliseconds: limitsOf(AccuracySchema.field.maxMilliseconds),
} as const satisfies Record<string, Limits>;

// Defaults of absent switches and choices.
export const DEFAULTS = {
  visible: defaultOnOf(FieldParametersSchema.field.visible),
  borders: defaultOnOf(GroundSchema.field.borders),
  rings: defaultOnOf(GroundSchema.field.rings),
  whiteBalance: defaultOnOf(DisplaySchema.field.whiteBalance),
  toneMap: defaultChoiceOf(DisplaySchema.field.toneMap) as ToneMap,
} as const;

export const MAX_LIGHTS = mostItemsOf(SceneSchema.field.lights);

// A change of a message: new values for some of its fields.
type Change<T extends Message> = Partial<Omit<T, keyof Message>>;

function changed<T extends Message>(message: T, change: Change<T>): T {
  return { ...message, ...change };
}

export function withCamera(scene: Scene, camera: Camera): Scene {
  return changed(scene, { camera });
}

export function withTime(scene: Scene, timeIndex: number): Scene {
  return changed(scene, { timeIndex });
}

export function withSun(scene: Scene, change: Change<Sun>): Scene {
  return changed(scene, { sun: changed(scene.sun ?? create(SunSchema), change) });
}

export function withSunClock(scene: Scene, change: Change<SunClock>): Scene {
  return withSun(scene, {
    clock: changed(scene.sun?.clock ?? create(SunClockSchema), change),
  });
}

// Sets all lights except the sun. The whole list is replaced, so that applying the same edit twice
// has no further effect.
export function withLights(scene: Scene, lights: readonly DirectionalLight[]): Scene {
  return changed(scene, { lights: [...lights] });
}

export function withLight(scene: Scene, index: number, change: Change<DirectionalLight>): Scene {
  return changed(scene, {
    lights: scene.lights.map((light, at) => (at === index ? changed(light, change) : light)),
  });
}

export function withSky(scene: Scene, change: Change<Sky>): Scene {
  return changed(scene, { sky: changed(scene.sky ?? create(SkySchema), change) });
}

export function withGround(scene: Scene, change: Change<Ground>): Scene {
  return changed(scene, { ground: changed(scene.ground ?? create(GroundSchema), change) });
}

export function withRendering(scene: Scene, rendering: Rendering | undefined): Scene {
  return changed(scene, { rendering });
}

// Returns the scene with rendering and fields as the server completed them, with every setting
// filled in. Returns the same scene if nothing was missing.
export function withCompleted(scene: Scene, { rendering, fields }: Scene): Scene {
  const sameRendering =
    rendering === undefined || isSame(RenderingSchema, scene.rendering, rendering);
  const sameFields =
    fields.length === scene.fields.length &&
    fields.every((field, at) => isSame(FieldParametersSchema, scene.fields[at], field));
  const next = sameRendering ? scene : withRendering(scene, rendering);
  return sameFields ? next : changed(next, { fields });
}

function isSame<T extends DescMessage>(
  schema: T,
  a: MessageShape<T> | undefined,
  b: MessageShape<T>,
): boolean {
  return a !== undefined && equals(schema, a, b);
}

// Replaces the rendering technique and its settings by a preset. The preset also determines where
// the particle sizes come from. Removes a goal (a required accuracy or speed), because the server
// would choose other settings to reach the goal.
export function withPreset(scene: Scene, preset: Preset): Scene {
  return changed(scene, {
    rendering: renderingOfPreset(preset),
    particleSizes: QUALITY_PRESETS.includes(preset) ? ParticleSizes.MODEL : ParticleSizes.PAPERS,
    accuracy: undefined,
  });
}

export function withDisplay(scene: Scene, change: Change<Display>): Scene {
  return changed(scene, { display: changed(scene.display ?? create(DisplaySchema), change) });
}

export function withOutput(scene: Scene, change: Change<Output>): Scene {
  return changed(scene, { output: changed(scene.output ?? create(OutputSchema), change) });
}

export function withAccuracy(scene: Scene, accuracy: Accuracy | undefined): Scene {
  return changed(scene, { accuracy });
}

// Changes one field's settings. Adds the field if the scene does not list it yet.
export function withField(
  scene: Scene,
  hydrometeor: Hydrometeor,
  change: Change<FieldParameters>,
): Scene {
  const listed = scene.fields.some((field) => field.hydrometeor === hydrometeor);
  const all = listed
    ? scene.fields
    : [...scene.fields, create(FieldParametersSchema, { hydrometeor })];
  return changed(scene, {
    fields: all.map((field) =>
      field.hydrometeor === hydrometeor ? changed(field, change) : field,
    ),
  });
}

// Changes the parameter of one field's phase function.
export function withAsymmetry(scene: Scene, hydrometeor: Hydrometeor, asymmetry: number): Scene {
  const field = scene.fields.find((other) => other.hydrometeor === hydrometeor);
  const phase = changed(field?.phase ?? create(PhaseFunctionSchema), { asymmetry });
  return withField(scene, hydrometeor, { phase });
}

// Changes one field's turbulent detail.
export function withDetail(scene: Scene, hydrometeor: Hydrometeor, change: Change<Detail>): Scene {
  const field = scene.fields.find((other) => other.hydrometeor === hydrometeor);
  const detail = changed(field?.detail ?? create(DetailSchema), change);
  return withField(scene, hydrometeor, { detail });
}

// Shows a time of another storm. Clears the fields, the camera and the sun's clock, because they
// belong to the old storm. Keeps light, rendering and picture settings.
export function withStorm(scene: Scene, stormId: string, timeIndex: number): Scene {
  const next = changed(scene, { stormId, timeIndex, camera: undefined, fields: [] });
  return next.sun?.clock === undefined ? next : withSun(next, { clock: undefined });
}

// Shows a time of another run of the same model, from the same place and with the same settings.
// The new run's first time is `laterS` seconds after the first time of the old run. The sun's clock
// is set for the first time, so it moves by the same amount.
export function withRun(scene: Scene, stormId: string, timeIndex: number, laterS: number): Scene {
  const next = changed(scene, { stormId, timeIndex });
  const first = Date.parse(scene.sun?.clock?.dateTime ?? "");
  if (Number.isNaN(first)) return next;
  return withSunClock(next, { dateTime: firstDateTime(new Date(first), -laterS) });
}

// Returns the source of a field's particle sizes. A radius that the field sets has priority, then
// the field's own source, then the scene's source.
function sizesOf(scene: Scene, set: FieldParameters | undefined): ParticleSizes {
  if (set?.radiusM !== undefined) return ParticleSizes.GIVEN;
  return set?.sizes || scene.particleSizes || ParticleSizes.MODEL;
}

// Sets the source of the particle sizes for all fields, and clears the sources and radii that were
// set for single fields.
export function withParticleSizes(scene: Scene, particleSizes: ParticleSizes): Scene {
  return changed(scene, {
    particleSizes,
    fields: scene.fields.map((field) =>
      changed(field, { sizes: ParticleSizes.UNSPECIFIED, radiusM: undefined }),
    ),
  });
}

// Sets the source of one field's particle sizes. `radiusM` is used only if the source is
// ParticleSizes.GIVEN.
export function withFieldSizes(
  scene: Scene,
  hydrometeor: Hydrometeor,
  sizes: ParticleSizes,
  radiusM: number,
): Scene {
  const given = sizes === ParticleSizes.GIVEN;
  return withField(scene, hydrometeor, { sizes, radiusM: given ? radiusM : undefined });
}

// Returns the settings with which a field is drawn. A setting that the scene does not have gets the
// default from the storm's description.
export function effectiveField(
  scene: Scene,
  hydrometeor: Hydrometeor,
  defaults: FieldParameters | undefined,
): FieldParameters {
  const set = scene.fields.find((field) => field.hydrometeor === hydrometeor);
  const phase = create(PhaseFunctionSchema, {
    kind: set?.phase?.kind || defaults?.phase?.kind || 0,
    asymmetry: set?.phase?.asymmetry ?? defaults?.phase?.asymmetry,
  });
  const detail = create(DetailSchema, {
    share: set?.detail?.share ?? defaults?.detail?.share,
    wavelengthM: set?.detail?.wavelengthM ?? defaults?.detail?.wavelengthM,
    octaves: set?.detail?.octaves ?? LIMITS.detailOctaves.defaultValue,
    seed: set?.detail?.seed ?? LIMITS.detailSeed.defaultValue,
  });
  return create(FieldParametersSchema, {
    hydrometeor,
    visible: set?.visible ?? defaults?.visible ?? DEFAULTS.visible,
    sizes: sizesOf(scene, set),
    scale: set?.scale ?? defaults?.scale ?? LIMITS.fieldScale.defaultValue,
    radiusM: set?.radiusM,
    densityKgPerM3: set?.densityKgPerM3 ?? defaults?.densityKgPerM3,
    albedo: set?.albedo ?? defaults?.albedo ?? LIMITS.fieldAlbedo.defaultValue,
    phase,
    detail,
    falseColor: set?.falseColor ?? defaults?.falseColor,
  });
}

// Returns the picture size for a canvas in device pixels, scaled by `resolution` and limited to the
// sizes that the server accepts.
export function outputSize(
  widthPx: number,
  heightPx: number,
  resolution: number,
): { widthPx: number; heightPx: number } {
  const fit = Math.min(
    resolution,
    LIMITS.width.maximum / Math.max(1, widthPx),
    LIMITS.height.maximum / Math.max(1, heightPx),
  );
  return {
    widthPx: clampToLimits(widthPx * fit, LIMITS.width),
    heightPx: clampToLimits(heightPx * fit, LIMITS.height),
  };
}

// Characters of the URL-safe base64 (RFC 4648, section 5) in which a serialized scene is written
// into an address.
const URL_ALPHABET = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

export function sceneToUrlText(scene: Scene): string {
  const bytes = toBinary(SceneSchema, scene);
  let text = "";
  for (let i = 0; i < bytes.length; i += 3) {
    const have = Math.min(3, bytes.length - i);
    const bits = ((bytes[i] ?? 0) << 16) | ((bytes[i + 1] ?? 0) << 8) | (bytes[i + 2] ?? 0);
    for (let k = 0; k <= have; k += 1) text += URL_ALPHABET[(bits >> (18 - 6 * k)) & 63];
  }
  return text;
}

// Reads a scene from the text of an address. Returns undefined if the text is not a scene, for
// example in a truncated link.
export function sceneFromUrlText(text: string): Scene | undefined {
  const bytes = new Uint8Array(Math.floor((text.length * 3) / 4));
  let bits = 0;
  for (let i = 0; i < text.length; i += 1) {
    const digit = URL_ALPHABET.indexOf(text.charAt(i));
    if (digit < 0) return undefined;
    bits = ((bits << 6) | digit) & 0xffffff;
    const bitsHeld = 6 * (i + 1);
    const byteIndex = Math.floor(bitsHeld / 8) - 1;
    if (bitsHeld % 8 < 6) bytes[byteIndex] = (bits >> (bitsHeld % 8)) & 255;
  }
  try {
    return fromBinary(SceneSchema, bytes);
  } catch {
    return undefined;
  }
}
