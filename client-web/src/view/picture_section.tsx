// Controls for the sky, the ground, and the picture's exposure, colours, resolution and
// compression.
import { DEFAULTS, LIMITS, withDisplay, withGround, withOutput, withSky } from "../core/scene";
import type { PageState } from "../core/state";
import { Ground_Cover, ToneMap } from "../gen/thunderhead/v1/scene_pb";
import { Choice, Section, Slider, Switch } from "./controls";
import type { Page } from "./page";

const TONE_MAPS = [
  [ToneMap.FILMIC, "Filmic"],
  [ToneMap.LINEAR, "Linear"],
] as const;

const GROUND_COVERS = [
  [Ground_Cover.PLAIN, "Plain"],
  [Ground_Cover.FIELDS, "Fields (made up)"],
  [Ground_Cover.LAND_USE, "Land use of the file"],
] as const;

const RESOLUTIONS = [
  [1, "Full"],
  [0.75, "Three quarters"],
  [0.5, "Half"],
  [0.25, "A quarter"],
] as const;

// The exposure, either automatic or set by hand.
export function ExposureControls({ state }: { state: PageState }) {
  const display = state.display.value;
  // If the exposure is automatic, the newest frame reports its value.
  const shownExposureEv =
    display?.exposureEv ?? Math.round(100 * (state.frame.value?.modelled?.exposureEv ?? 0)) / 100;
  return (
    <>
      <Switch
        label="Automatic exposure"
        checked={display?.exposureEv === undefined}
        testId="automatic-exposure"
        onChange={(automatic) =>
          state.edit((scene) =>
            withDisplay(scene, { exposureEv: automatic ? undefined : shownExposureEv }),
          )
        }
      />
      <Slider
        label="Exposure, stops"
        limits={LIMITS.exposure}
        value={shownExposureEv}
        testId="exposure"
        onChange={(exposureEv) => state.edit((scene) => withDisplay(scene, { exposureEv }))}
      />
    </>
  );
}

export function PictureSection({ page }: { page: Page }) {
  const { state } = page;
  const sky = state.sky.value;
  const ground = state.ground.value;
  const modelledGround = state.frame.value?.modelled?.ground;
  const display = state.display.value;
  return (
    <Section title="Sky, ground and picture" testId="picture-section">
      <Switch
        label="White balance"
        checked={display?.whiteBalance ?? DEFAULTS.whiteBalance}
        testId="white-balance"
        onChange={(whiteBalance) => state.edit((scene) => withDisplay(scene, { whiteBalance }))}
      />
      <Choice
        label="Tone map"
        testId="tone-map"
        value={display?.toneMap || DEFAULTS.toneMap}
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
        label="Ground albedo"
        limits={LIMITS.groundAlbedo}
        value={sky?.groundAlbedo ?? LIMITS.groundAlbedo.defaultValue}
        testId="ground-albedo"
        onChange={(groundAlbedo) => state.edit((scene) => withSky(scene, { groundAlbedo }))}
      />
      <Choice
        label="Ground"
        testId="ground-cover"
        value={ground?.cover || modelledGround?.cover || Ground_Cover.PLAIN}
        options={GROUND_COVERS}
        onChange={(cover) => state.edit((scene) => withGround(scene, { cover }))}
      />
      {ground?.cover === Ground_Cover.LAND_USE && modelledGround?.cover === Ground_Cover.PLAIN && (
        <p class="quiet" data-testid="no-land-use">
          This file has no land use.
        </p>
      )}
      <Switch
        label="Coasts and borders"
        checked={ground?.borders ?? DEFAULTS.borders}
        testId="borders"
        onChange={(borders) => state.edit((scene) => withGround(scene, { borders }))}
      />
      <Switch
        label="Rings every 10 km"
        checked={ground?.rings ?? DEFAULTS.rings}
        testId="rings"
        onChange={(rings) => state.edit((scene) => withGround(scene, { rings }))}
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
