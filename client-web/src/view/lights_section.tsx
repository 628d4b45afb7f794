// Controls for the lights other than the sun: direction and colour of each.
import { create } from "@bufbuild/protobuf";
import { colorOfHex, hexOfColor } from "../core/color";
import { nameOfTechnique } from "../core/names";
import { LIMITS, MAX_LIGHTS, withLight, withLights } from "../core/scene";
import type { PageState } from "../core/state";
import { gridAzimuthDeg, trueAzimuthDeg } from "../core/sun";
import {
  ColorSchema,
  type DirectionalLight,
  DirectionalLightSchema,
} from "../gen/thunderhead/v1/scene_pb";
import { Section, Slider } from "./controls";

const WHITE = { red: 1, green: 1, blue: 1 };
// Colours of lights that are added one after another, so that each looks different.
const FIRST_COLORS = ["#ff9a4d", "#4d8dff", "#ffffff", "#c04dff"];

export function LightsSection({ state }: { state: PageState }) {
  const lights = state.lights.value;
  return (
    <Section title="Lights other than the sun" testId="lights-section">
      <p class="quiet" data-testid="lights-shown">
        These lights illuminate only the storm. {whereShown(state)}
      </p>
      {lights.map((light, index) => (
        <LightSettings key={index} state={state} light={light} index={index} />
      ))}
      <div class="buttons">
        <button
          type="button"
          data-testid="add-light"
          disabled={lights.length >= MAX_LIGHTS}
          onClick={() => setLights(state, [...lights, newLight(lights.length)])}
        >
          Add a light
        </button>
      </div>
    </Section>
  );
}

function whereShown(state: PageState): string {
  const drawn = state.drawnTechnique.value;
  if (drawn === undefined) return "";
  if (drawn.showsLights) return "Shown by the technique under Look.";
  const able = (state.server.value?.techniques ?? []).filter(({ showsLights }) => showsLights);
  const names = able.map((technique) => nameOfTechnique(technique.name)).join(", ");
  return `Not shown by the technique under Look, but by: ${names}.`;
}

function setLights(state: PageState, lights: readonly DirectionalLight[]): void {
  state.edit((scene) => withLights(scene, lights));
}

function newLight(count: number): DirectionalLight {
  const hex = FIRST_COLORS[count % FIRST_COLORS.length] ?? "#ffffff";
  return create(DirectionalLightSchema, {
    azimuthDeg: (LIMITS.lightAzimuth.defaultValue ?? 0) + 90 * count,
    color: create(ColorSchema, colorOfHex(hex)),
  });
}

interface LightProps {
  readonly state: PageState;
  readonly light: DirectionalLight;
  readonly index: number;
}

function LightSettings({ state, light, index }: LightProps) {
  const name = `Light ${index + 1}`;
  const id = `light-${index + 1}`;
  const trueNorthDeg = state.trueNorthDeg.value;
  const edit = (change: Parameters<typeof withLight>[2]) =>
    state.edit((scene) => withLight(scene, index, change));
  return (
    <fieldset class="field" data-testid={id}>
      <legend class="visually-hidden">{name}</legend>
      <div class="field-head">
        <span>{name}</span>
        <span class="light-tools">
          <input
            type="color"
            aria-label={`${name}: colour`}
            title="Colour"
            data-testid={`${id}-color`}
            value={hexOfColor(light.color ?? WHITE)}
            onInput={(event) =>
              edit({ color: create(ColorSchema, colorOfHex(event.currentTarget.value)) })
            }
          />
          <button
            type="button"
            class="remove"
            aria-label={`Remove ${name}`}
            title="Remove"
            data-testid={`${id}-remove`}
            onClick={() =>
              setLights(
                state,
                state.lights.peek().filter((_, at) => at !== index),
              )
            }
          >
            ×
          </button>
        </span>
      </div>
      <Slider
        label="Azimuth"
        limits={LIMITS.lightAzimuth}
        value={trueAzimuthDeg(
          light.azimuthDeg ?? LIMITS.lightAzimuth.defaultValue ?? 0,
          trueNorthDeg,
        )}
        testId={`${id}-azimuth`}
        onChange={(deg) => edit({ azimuthDeg: gridAzimuthDeg(deg, trueNorthDeg) })}
      />
      <Slider
        label="Elevation"
        limits={LIMITS.lightElevation}
        value={light.elevationDeg ?? LIMITS.lightElevation.defaultValue}
        testId={`${id}-elevation`}
        onChange={(elevationDeg) => edit({ elevationDeg })}
      />
      <Slider
        label="Irradiance"
        limits={LIMITS.lightIrradiance}
        value={light.irradiance ?? LIMITS.lightIrradiance.defaultValue}
        testId={`${id}-irradiance`}
        onChange={(irradiance) => edit({ irradiance })}
      />
    </fieldset>
  );
}
