// The storm's fields, one row each: visibility, scale, colour, particles and detail.
import { create, isMessage } from "@bufbuild/protobuf";
import { colorOfHex, hexOfColor } from "../core/color";
import { nameOfHydrometeor, namesOfPhases } from "../core/names";
import {
  DEFAULTS,
  effectiveField,
  LIMITS,
  withAsymmetry,
  withDetail,
  withField,
  withFieldSizes,
  withParticleSizes,
} from "../core/scene";
import type { PageState } from "../core/state";
import { formatNumber } from "../core/units";
import {
  ColorSchema,
  PhaseFunction_Kind as Kind,
  MetaballsSchema,
  ParticleSizes,
  PhaseFunctionSchema,
} from "../gen/thunderhead/v1/scene_pb";
import {
  type FieldDescription,
  FieldDescription_SizeOrigin as SizeOrigin,
} from "../gen/thunderhead/v1/storm_pb";
import { Choice, Slider, Switch } from "./controls";

const WITH_ASYMMETRY: readonly Kind[] = [Kind.HENYEY_GREENSTEIN, Kind.CORNETTE_SHANKS];

export function FieldsSection({ state }: { state: PageState }) {
  const storm = state.storm.value;
  return (
    <div class="fields" data-testid="fields">
      {storm === undefined && <p class="quiet">Waiting for the storm's description …</p>}
      {storm?.fields.some((field) => field.units !== EXTINCTION_UNITS) && (
        <Choice
          label="Particle sizes"
          testId="particle-sizes"
          value={state.particleSizes.value || ParticleSizes.MODEL}
          options={[
            [ParticleSizes.MODEL, "As the model has them"],
            [ParticleSizes.PAPERS, "The papers' constants"],
          ]}
          onChange={(sizes) => state.edit((scene) => withParticleSizes(scene, sizes))}
        />
      )}
      {storm?.fields.map((field) => (
        <FieldRow key={field.hydrometeor} state={state} field={field} />
      ))}
    </div>
  );
}

// Returns true if a change of extinction makes the server fit metaballs again, which takes seconds.
function fitsAnew(state: PageState): boolean {
  const settings = state.settings.value;
  return settings !== undefined && isMessage(settings, MetaballsSchema);
}

function FieldRow({ state, field }: { state: PageState; field: FieldDescription }) {
  const { hydrometeor, defaults } = field;
  const { shown, id, edit } = controlsOf(state, field);
  const name = nameOfHydrometeor(hydrometeor);
  const color = hexOfColor(shown.falseColor ?? { red: 1, green: 1, blue: 1 });
  return (
    <fieldset class={shown.visible ? "field" : "field off"} data-testid={`field-${id}`}>
      <legend class="visually-hidden">{name}</legend>
      <div class="field-head">
        <Switch
          label={name}
          testId={`field-${id}-visible`}
          checked={shown.visible ?? DEFAULTS.visible}
          onChange={(visible) => edit({ visible })}
        />
        {state.falseColorsShown.value && (
          <input
            type="color"
            aria-label={`${name}: false colour`}
            title="False colour"
            data-testid={`field-${id}-color`}
            value={color}
            onInput={(event) =>
              edit({ falseColor: create(ColorSchema, colorOfHex(event.currentTarget.value)) })
            }
          />
        )}
        <Slider
          label={`${name}: amount`}
          limits={LIMITS.fieldScale}
          value={shown.scale}
          initial={defaults?.scale}
          testId={`field-${id}-scale`}
          afterRest={fitsAnew(state)}
          inLine
          onChange={(scale) => edit({ scale })}
        />
      </div>
      {field.units !== EXTINCTION_UNITS && (
        <p class="quiet" data-testid={`field-${id}-size`}>
          {sizeInWords(field, shown)}
        </p>
      )}
      <details class="folded">
        <summary>
          More<span class="visually-hidden"> about {name}</span>
        </summary>
        <h3>Particles</h3>
        <ParticleSettings state={state} field={field} />
        {state.detailShown.value && (
          <>
            <h3>Detail</h3>
            <DetailSettings state={state} field={field} />
          </>
        )}
      </details>
    </fieldset>
  );
}

// Unit of fields that contain extinction instead of a mass. Particle size has no effect on such
// fields.
const EXTINCTION_UNITS = "m-1";

function amountOf(field: FieldDescription): string {
  const path = formatNumber(field.meanWaterPathKgPerM2);
  if (field.units === EXTINCTION_UNITS) {
    return `${field.variable}: up to ${formatNumber(field.maximum * 1000)} /km, mean optical depth ${path}`;
  }
  const unit = field.units === "kg m-3" ? "g/m³" : "g/kg";
  return `${field.variable}: up to ${formatNumber(field.maximum * 1000)} ${unit}, column mean ${path} kg/m²`;
}

function micrometres(radiusM: number): string {
  return `${formatNumber(radiusM * 1e6)} µm`;
}

// Describes the source of the particle radius with which the picture is drawn.
function sizeInWords(field: FieldDescription, shown: ReturnType<typeof effectiveField>): string {
  switch (shown.sizes) {
    case ParticleSizes.PAPERS:
      return `Radius by the papers: ${micrometres(field.papersRadiusM)}`;
    case ParticleSizes.GIVEN:
      return `One radius: ${micrometres(shown.radiusM ?? field.papersRadiusM)}`;
    default: {
      const origin = `${PREPOSITIONS[field.sizeOrigin] ?? ""}${originOf(field)}`;
      return `Radius ${origin}${meanRadius(field, ", mean ")}`;
    }
  }
}

// Returns the name of the model's variable or microphysics scheme from which the particle sizes
// come; "as observed" if they come from neither.
function originOf(field: FieldDescription): string {
  switch (field.sizeOrigin) {
    case SizeOrigin.EFFECTIVE_RADIUS:
    case SizeOrigin.NUMBER:
      return field.sizeVariable;
    case SizeOrigin.SCHEME:
      return field.sizeScheme;
    default:
      return "as observed";
  }
}

const PREPOSITIONS: Partial<Record<SizeOrigin, string>> = {
  [SizeOrigin.EFFECTIVE_RADIUS]: "from ",
  [SizeOrigin.NUMBER]: "from ",
  [SizeOrigin.SCHEME]: "by ",
};

// Returns the field's mean effective radius as a text that begins with `before`; empty if the field
// has no radius.
function meanRadius(field: FieldDescription, before: string): string {
  return field.meanRadiusM > 0 ? `${before}${micrometres(field.meanRadiusM)}` : "";
}

// Returns a field's settings from the scene, the prefix of its test ids, and the function that
// changes them. The component is drawn again when the fields change, but not with every change of
// the scene.
function controlsOf(state: PageState, { hydrometeor, defaults }: FieldDescription) {
  void state.fields.value;
  void state.particleSizes.value;
  return {
    shown: effectiveField(state.scene.peek(), hydrometeor, defaults),
    id: nameOfHydrometeor(hydrometeor).toLowerCase(),
    edit: (change: Parameters<typeof withField>[2]) =>
      state.edit((scene) => withField(scene, hydrometeor, change)),
  };
}

function ParticleSettings({ state, field }: { state: PageState; field: FieldDescription }) {
  const { defaults } = field;
  const { shown, id, edit } = controlsOf(state, field);
  return (
    <>
      {field.units !== EXTINCTION_UNITS && (
        <>
          <Choice
            label="Sizes"
            testId={`field-${id}-sizes`}
            value={shown.sizes}
            options={[
              [ParticleSizes.MODEL, `Model: ${originOf(field)}${meanRadius(field, ", ")}`],
              [ParticleSizes.PAPERS, `Papers: ${micrometres(field.papersRadiusM)}`],
              [ParticleSizes.GIVEN, "One radius"],
            ]}
            onChange={(sizes) =>
              state.edit((scene) =>
                withFieldSizes(
                  scene,
                  field.hydrometeor,
                  sizes,
                  field.meanRadiusM || field.papersRadiusM,
                ),
              )
            }
          />
          {shown.sizes === ParticleSizes.GIVEN && (
            <Slider
              label="Radius"
              limits={LIMITS.fieldRadius}
              value={shown.radiusM}
              initial={field.meanRadiusM || undefined}
              testId={`field-${id}-radius`}
              afterRest={fitsAnew(state)}
              onChange={(radiusM) => edit({ radiusM })}
            />
          )}
          <Slider
            label="Density"
            limits={LIMITS.fieldDensity}
            value={shown.densityKgPerM3}
            initial={defaults?.densityKgPerM3}
            testId={`field-${id}-density`}
            afterRest={fitsAnew(state)}
            onChange={(densityKgPerM3) => edit({ densityKgPerM3 })}
          />
        </>
      )}
      {state.drawnTechnique.value?.showsFieldOptics && (
        <OpticsSettings state={state} field={field} />
      )}
      <p class="quiet">
        {amountOf(field)} at this time
        {field.missingCells > 0n && `; ${field.missingCells} cells missing`}
      </p>
    </>
  );
}

// Shows how the field's particles scatter light.
function OpticsSettings({ state, field }: { state: PageState; field: FieldDescription }) {
  const { defaults } = field;
  const { shown, id, edit } = controlsOf(state, field);
  const { phase } = shown;
  return (
    <>
      <Slider
        label="Albedo"
        limits={LIMITS.fieldAlbedo}
        value={shown.albedo}
        initial={defaults?.albedo}
        testId={`field-${id}-albedo`}
        onChange={(albedo) => edit({ albedo })}
      />
      <Choice
        label="Phase"
        testId={`field-${id}-phase`}
        value={phase?.kind || Kind.HENYEY_GREENSTEIN}
        options={namesOfPhases()}
        onChange={(kind) =>
          edit({ phase: create(PhaseFunctionSchema, { kind, asymmetry: phase?.asymmetry }) })
        }
      />
      {phase && WITH_ASYMMETRY.includes(phase.kind) && (
        <Slider
          label="Asymmetry g"
          limits={LIMITS.phaseAsymmetry}
          value={phase?.asymmetry}
          initial={defaults?.phase?.asymmetry}
          testId={`field-${id}-asymmetry`}
          onChange={(g) => state.edit((scene) => withAsymmetry(scene, field.hydrometeor, g))}
        />
      )}
    </>
  );
}

function DetailSettings({ state, field }: { state: PageState; field: FieldDescription }) {
  const { hydrometeor, defaults } = field;
  void state.fields.value;
  const { detail } = effectiveField(state.scene.peek(), hydrometeor, defaults);
  const id = nameOfHydrometeor(hydrometeor).toLowerCase();
  const edit = (change: Parameters<typeof withDetail>[2]) =>
    state.edit((scene) => withDetail(scene, hydrometeor, change));
  return (
    <>
      <Slider
        label="Strength"
        limits={LIMITS.detailShare}
        value={detail?.share}
        initial={defaults?.detail?.share}
        testId={`field-${id}-detail-share`}
        onChange={(share) => edit({ share })}
      />
      <Slider
        label="Largest billows"
        limits={LIMITS.detailWavelength}
        value={detail?.wavelengthM}
        initial={defaults?.detail?.wavelengthM}
        testId={`field-${id}-detail-wavelength`}
        onChange={(wavelengthM) => edit({ wavelengthM })}
      />
      <Slider
        label="Levels of finer ones"
        limits={LIMITS.detailOctaves}
        value={detail?.octaves}
        testId={`field-${id}-detail-octaves`}
        onChange={(octaves) => edit({ octaves })}
      />
      <Slider
        label="Pattern"
        limits={LIMITS.detailSeed}
        value={detail?.seed}
        testId={`field-${id}-detail-seed`}
        onChange={(seed) => edit({ seed })}
      />
    </>
  );
}
