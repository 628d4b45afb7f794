// The panel at the side: everything that can be set, part by part.
import { useState } from "preact/hooks";
import {
  LIMITS,
  withDisplay,
  withMetaballs,
  withOutput,
  withRendering,
  withSky,
} from "../core/scene";
import type { PageState } from "../core/state";
import { Mode, Renderer, type Rendering, ToneMap, Transport } from "../gen/thunderhead/v1/scene_pb";
import { AccuracySection } from "./accuracy_section";
import { CameraSection } from "./camera_section";
import { CloudSection } from "./cloud_section";
import { Choice, Section, Slider, Switch } from "./controls";
import { CumulusControls } from "./cumulus_controls";
import { FieldsSection } from "./fields_section";
import { KEYS } from "./keyboard";
import { LightsSection } from "./lights_section";
import type { Page } from "./page";
import { SunSection } from "./sun_section";

const RENDERERS = [
  [Renderer.LIGHT_VOLUME, "Light volume"],
  [Renderer.HALF_ANGLE, "Half-angle slices"],
  [Renderer.METABALL, "Metaballs"],
  [Renderer.REFERENCE, "Reference: refine to truth"],
  [Renderer.CUMULUS, "Cumulus surface"],
] as const;

const MODES = [
  [Mode.PER_FIELD_PHASE_DETAIL_TRANSLUCENT, "Phase per field, detail, translucent"],
  [Mode.PER_FIELD_PHASE_TRANSLUCENT, "Phase per field, translucent"],
  [Mode.UNIFORM_PHASE_TRANSLUCENT, "Uniform phase, translucent"],
  [Mode.UNIFORM_PHASE_LOW_ALBEDO, "Uniform phase, low albedo"],
] as const;

const TRANSPORTS = [
  [Transport.CONSISTENT, "Consistent"],
  [Transport.DIFFUSION, "Diffusion"],
  [Transport.PAPER, "As in the paper"],
] as const;

const TONE_MAPS = [
  [ToneMap.FILMIC, "Filmic"],
  [ToneMap.LINEAR, "Linear"],
] as const;

const RESOLUTIONS = [
  [1, "Full"],
  [0.75, "Three quarters"],
  [0.5, "Half"],
  [0.25, "A quarter"],
] as const;

export function Panel({ page }: { page: Page }) {
  const { state } = page;
  const open = state.panelOpen.value;
  return (
    <>
      <button
        type="button"
        class="panel-toggle"
        data-testid="panel-toggle"
        aria-expanded={open}
        aria-controls="panel"
        title="Show or hide the settings (P)"
        onClick={() => page.togglePanel()}
      >
        {open ? "Hide settings" : "Settings"}
      </button>
      <aside id="panel" class="panel" aria-label="Settings" data-testid="panel" hidden={!open}>
        <StormSection page={page} />
        <CloudSection page={page} />
        <CameraSection page={page} />
        <SunSection state={state} />
        <LightsSection state={state} />
        <FieldsSection state={state} />
        <AccuracySection state={state} />
        <RenderingSection state={state} />
        <PictureSection page={page} />
        <HelpSection />
      </aside>
    </>
  );
}

function StormSection({ page }: { page: Page }) {
  const { state } = page;
  const storms = state.storms.value;
  const shown = storms.find((storm) => storm.id === state.stormId.value);
  return (
    <Section title="Storm" open testId="storm-section">
      <Choice
        label="Storm"
        testId="storm"
        value={state.stormId.value}
        options={storms.map((storm) => [storm.id, storm.title || storm.id] as const)}
        onChange={(id) => page.showStorm(id)}
      />
      <div class="buttons">
        <button type="button" data-testid="home" onClick={() => page.home()}>
          Whole storm
        </button>
        <button
          type="button"
          data-testid="copy-link"
          disabled={state.session.value === undefined}
          onClick={() => void page.copyLink()}
        >
          Copy link
        </button>
        {shown?.deletable && <DeleteCloud key={shown.id} page={page} />}
      </div>
    </Section>
  );
}

// Asks once more before it deletes.
function DeleteCloud({ page }: { page: Page }) {
  const [asked, setAsked] = useState(false);
  return (
    <button
      type="button"
      data-testid="delete-cloud"
      onBlur={() => setAsked(false)}
      onClick={() => (asked ? void page.deleteCloud() : setAsked(true))}
    >
      {asked ? "Delete it for all viewers?" : "Delete this cloud"}
    </button>
  );
}

function showsTracedLight(rendering: Rendering | undefined): boolean {
  return (
    rendering?.transport === Transport.DIFFUSION &&
    (rendering.renderer || Renderer.LIGHT_VOLUME) === Renderer.LIGHT_VOLUME &&
    rendering.mode !== Mode.UNIFORM_PHASE_LOW_ALBEDO
  );
}

function RenderingSection({ state }: { state: PageState }) {
  const rendering = state.rendering.value;
  return (
    <Section title="Light in the cloud" testId="rendering-section">
      <Choice
        label="Renderer"
        testId="renderer-choice"
        value={rendering?.renderer || Renderer.LIGHT_VOLUME}
        options={RENDERERS}
        onChange={(renderer) => state.edit((scene) => withRendering(scene, { renderer }))}
      />
      <NotShown state={state} />
      {rendering?.renderer === Renderer.METABALL && <MetaballSettings state={state} />}
      {rendering?.renderer === Renderer.CUMULUS && <CumulusControls state={state} />}
      <Choice
        label="Mode"
        testId="mode"
        value={rendering?.mode || Mode.PER_FIELD_PHASE_TRANSLUCENT}
        options={MODES}
        onChange={(mode) => state.edit((scene) => withRendering(scene, { mode }))}
      />
      <Choice
        label="Transport"
        testId="transport"
        value={rendering?.transport || Transport.CONSISTENT}
        options={TRANSPORTS}
        onChange={(transport) => state.edit((scene) => withRendering(scene, { transport }))}
      />
      {showsTracedLight(rendering) && (
        <Switch
          label="Trace the light at rest"
          testId="traced-light"
          checked={rendering?.tracedLight ?? false}
          onChange={(tracedLight) => state.edit((scene) => withRendering(scene, { tracedLight }))}
        />
      )}
      <Slider
        label="Slices"
        limits={LIMITS.slices}
        value={rendering?.slices ?? LIMITS.slices.defaultValue}
        testId="slices"
        onChange={(slices) => state.edit((scene) => withRendering(scene, { slices }))}
      />
      <Slider
        label="Forward angle θf"
        limits={LIMITS.thetaF}
        value={rendering?.thetaFDeg ?? LIMITS.thetaF.defaultValue}
        testId="theta-f"
        onChange={(thetaFDeg) => state.edit((scene) => withRendering(scene, { thetaFDeg }))}
      />
    </Section>
  );
}

// What the renderer of the picture on the screen leaves out.
function NotShown({ state }: { state: PageState }) {
  const notShown = state.frame.value?.modelled?.notShown ?? [];
  if (notShown.length === 0) return null;
  return (
    <p class="quiet" data-testid="not-shown">
      Not shown: {notShown.join(", ")}.
    </p>
  );
}

function MetaballSettings({ state }: { state: PageState }) {
  const rendering = state.rendering.value;
  const metaballs = rendering?.metaballs;
  return (
    <>
      <Slider
        label="Metaballs"
        limits={LIMITS.metaballCount}
        value={metaballs?.count ?? LIMITS.metaballCount.defaultValue}
        testId="metaball-count"
        afterRest
        onChange={(count) => state.edit((scene) => withMetaballs(scene, { count }))}
      />
      <Switch
        label="Scatter evenly to all sides"
        checked={metaballs?.isotropic ?? false}
        testId="metaball-isotropic"
        onChange={(isotropic) => state.edit((scene) => withMetaballs(scene, { isotropic }))}
      />
      {rendering?.transport === Transport.PAPER && (
        <>
          <Slider
            label="Albedo a"
            limits={LIMITS.metaballAlbedo}
            value={metaballs?.albedo ?? LIMITS.metaballAlbedo.defaultValue}
            testId="metaball-albedo"
            onChange={(albedo) => state.edit((scene) => withMetaballs(scene, { albedo }))}
          />
          <Slider
            label="Optical depth τ"
            limits={LIMITS.metaballOpticalDepth}
            value={metaballs?.opticalDepth ?? LIMITS.metaballOpticalDepth.defaultValue}
            testId="metaball-optical-depth"
            onChange={(opticalDepth) =>
              state.edit((scene) => withMetaballs(scene, { opticalDepth }))
            }
          />
        </>
      )}
    </>
  );
}

function PictureSection({ page }: { page: Page }) {
  const { state } = page;
  const sky = state.sky.value;
  const display = state.display.value;
  return (
    <Section title="Sky and picture" testId="picture-section">
      <Slider
        label="Exposure"
        limits={LIMITS.exposure}
        value={display?.exposureEv ?? LIMITS.exposure.defaultValue}
        testId="exposure"
        onChange={(exposureEv) => state.edit((scene) => withDisplay(scene, { exposureEv }))}
      />
      <Choice
        label="Tone map"
        testId="tone-map"
        value={display?.toneMap || ToneMap.FILMIC}
        options={TONE_MAPS}
        onChange={(toneMap) => state.edit((scene) => withDisplay(scene, { toneMap }))}
      />
      <Slider
        label="Sky brightness"
        limits={LIMITS.skyBrightness}
        value={sky?.brightness ?? LIMITS.skyBrightness.defaultValue}
        testId="sky-brightness"
        onChange={(brightness) => state.edit((scene) => withSky(scene, { brightness }))}
      />
      <Slider
        label="Turbidity of the air"
        limits={LIMITS.turbidity}
        value={sky?.turbidity ?? LIMITS.turbidity.defaultValue}
        testId="turbidity"
        onChange={(turbidity) => state.edit((scene) => withSky(scene, { turbidity }))}
      />
      <Slider
        label="Ground albedo"
        limits={LIMITS.groundAlbedo}
        value={sky?.groundAlbedo ?? LIMITS.groundAlbedo.defaultValue}
        testId="ground-albedo"
        onChange={(groundAlbedo) => state.edit((scene) => withSky(scene, { groundAlbedo }))}
      />
      <Choice
        label="Resolution"
        testId="resolution"
        value={state.resolution.value}
        options={RESOLUTIONS}
        onChange={(share) => page.setResolution(share)}
      />
      <Slider
        label="JPEG quality"
        limits={LIMITS.jpegQuality}
        value={state.output.value?.jpegQuality ?? LIMITS.jpegQuality.defaultValue}
        testId="jpeg-quality"
        onChange={(jpegQuality) => state.edit((scene) => withOutput(scene, { jpegQuality }))}
      />
    </Section>
  );
}

function HelpSection() {
  return (
    <Section title="Mouse, touch and keys" testId="help-section">
      <dl class="keys">
        {KEYS.map(([key, what]) => (
          <div key={key}>
            <dt>{key}</dt>
            <dd>{what}</dd>
          </div>
        ))}
      </dl>
    </Section>
  );
}
