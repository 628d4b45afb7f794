// The inset map shows the storm's water path (mass of water in each column), coasts and borders,
// the camera with its angle of view, and the sun. A click moves the camera to that place. A drag
// from there sets the camera's direction. A double click makes the camera turn around that place.
import { useEffect, useRef, useState } from "preact/hooks";
import type { Pose, TopDownPose } from "../../core/camera";
import { type Extent, extentOf, placeOnMap, standOf, worldOfMap } from "../../core/map_frame";
import type { PageState } from "../../core/state";
import { formatLength, roundLength } from "../../core/units";
import type { GetStormMapResponse } from "../../gen/thunderhead/v1/probe_pb";
import { withPart } from "../part";
import type { MapLines } from "./map_lines";

export interface MapSteps {
  stand(placeM: readonly [number, number], lookDeg?: number): void;
  turnAround(placeM: readonly [number, number]): void;
}

// Maximum time in milliseconds between the two clicks of a double click.
const DOUBLE_CLICK_MS = 230;
const DRAG_PX = 5;
// Step of an arrow key, as a fraction of the map's width.
const CURSOR_STEP = 0.025;
const SIZE = 100;

export function InsetMap({ state, steps }: { state: PageState; steps: MapSteps }) {
  const map = state.stormMap.value;
  const stand = standOf(state.viewPose.value);
  const extent = extentOf(domainOf(map, state), stand?.placeM);
  const lines = useLines(state, map);
  const [cursor, setCursor] = useState<{ right: number; down: number } | undefined>(undefined);
  const pointer = usePointer(extent, steps);
  const key = (event: KeyboardEvent) => {
    const at = cursor ?? { right: 0.5, down: 0.5 };
    const by = ARROWS[event.key];
    if (by !== undefined) {
      const step = event.shiftKey ? 4 * CURSOR_STEP : CURSOR_STEP;
      setCursor({ right: clamp(at.right + by[0] * step), down: clamp(at.down + by[1] * step) });
    } else if (event.key === "Enter" || event.key === " ") steps.stand(worldOfMap(extent, at));
    else if (event.key.toLowerCase() === "o") steps.turnAround(worldOfMap(extent, at));
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <div
      class="inset-map"
      role="application"
      // biome-ignore lint/a11y/noNoninteractiveTabindex: an application is interactive and has its own keys.
      tabIndex={0}
      aria-label="Map of the storm. Arrow keys move a cross, Enter stands there, O turns around that place."
      data-testid="inset-map"
      onKeyDown={key}
      onFocus={() => setCursor(cursor ?? { right: 0.5, down: 0.5 })}
      onBlur={() => setCursor(undefined)}
      {...pointer}
    >
      {map !== undefined && <WaterPath map={map} extent={extent} />}
      <svg viewBox={`0 0 ${SIZE} ${SIZE}`} aria-hidden="true">
        <Lines lines={lines} extent={extent} />
        <Domain state={state} extent={extent} map={map} />
        <CameraOnMap state={state} extent={extent} />
        <SunOnMap azimuthDeg={state.sunDirection.value.azimuthDeg} />
        {cursor !== undefined && <Cross {...cursor} />}
        <North trueNorthDeg={state.trueNorthDeg.value} />
        <ScaleBar extent={extent} cameraM={cameraPlace(state.viewPose.value)} />
      </svg>
    </div>
  );
}

const ARROWS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

const clamp = (share: number) => Math.min(1, Math.max(0, share));

// Returns the domain that the map covers. Before the server has sent the map, the domain comes from
// the storm's description. Without a description it is 100 km wide.
function domainOf(map: GetStormMapResponse | undefined, state: PageState): Extent {
  const grid = state.storm.value?.grid;
  const low = map?.low ?? grid?.low;
  const high = map?.high ?? grid?.high;
  return {
    westM: low?.xM ?? -50_000,
    southM: low?.yM ?? -50_000,
    eastM: high?.xM ?? 50_000,
    northM: high?.yM ?? 50_000,
  };
}

function useLines(state: PageState, map: GetStormMapResponse | undefined): MapLines | undefined {
  const [lines, setLines] = useState<MapLines | undefined>(undefined);
  const middle = map?.middle;
  const places = map?.places;
  useEffect(() => {
    if (middle === undefined || places === undefined) {
      setLines(undefined);
      return undefined;
    }
    let wanted = true;
    withPart(
      state,
      "The map's coasts and borders",
      async () => (await import("./map_lines")).mapLines(middle, places),
      (found) => wanted && setLines(found),
    );
    return () => {
      wanted = false;
    };
  }, [state, middle, places]);
  return lines;
}

interface Pressed {
  readonly x: number;
  readonly y: number;
  readonly world: [number, number];
  drags: boolean;
}

function usePointer(extent: Extent, steps: MapSteps) {
  const pressed = useRef<Pressed | undefined>(undefined);
  const single = useRef<ReturnType<typeof setTimeout> | undefined>(undefined);
  useEffect(() => () => clearTimeout(single.current), []);
  const worldAt = (event: PointerEvent & { currentTarget: HTMLElement }) => {
    const box = event.currentTarget.getBoundingClientRect();
    return worldOfMap(extent, {
      right: (event.clientX - box.left) / box.width,
      down: (event.clientY - box.top) / box.height,
    });
  };
  return {
    onPointerDown: (event: PointerEvent & { currentTarget: HTMLElement }) => {
      event.currentTarget.setPointerCapture(event.pointerId);
      pressed.current = { x: event.clientX, y: event.clientY, world: worldAt(event), drags: false };
    },
    onPointerMove: (event: PointerEvent & { currentTarget: HTMLElement }) => {
      const start = pressed.current;
      if (start === undefined) return;
      const away = Math.hypot(event.clientX - start.x, event.clientY - start.y);
      start.drags ||= away > DRAG_PX;
      if (!start.drags) return;
      const [x, y] = worldAt(event);
      const look = (Math.atan2(x - start.world[0], y - start.world[1]) * 180) / Math.PI;
      steps.stand(start.world, look);
    },
    onPointerUp: () => {
      const start = pressed.current;
      pressed.current = undefined;
      if (start === undefined || start.drags) return;
      if (single.current !== undefined) {
        clearTimeout(single.current);
        single.current = undefined;
        steps.turnAround(start.world);
        return;
      }
      single.current = setTimeout(() => {
        single.current = undefined;
        steps.stand(start.world);
      }, DOUBLE_CLICK_MS);
    },
    onPointerCancel: () => {
      pressed.current = undefined;
    },
  };
}

// Water paths as fractions of the map's largest water path. A column above WHITE_SHARE is fully
// white, and FAINTEST_SHARE is the smallest visible path. The scale between them is logarithmic,
// because water paths span many powers of ten.
const WHITE_SHARE = 0.6;
const FAINTEST_SHARE = 2e-4;

function WaterPath({ map, extent }: { map: GetStormMapResponse; extent: Extent }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const context = canvas.current?.getContext("2d");
    if (context === undefined || context === null || map.widthPx === 0) return;
    const image = context.createImageData(map.widthPx, map.heightPx);
    const [faintest, whitest] = [FAINTEST_SHARE * map.maximum, WHITE_SHARE * map.maximum];
    for (let row = 0; row < map.heightPx; row += 1) {
      for (let column = 0; column < map.widthPx; column += 1) {
        const value = map.values[row * map.widthPx + column] ?? 0;
        // The map's rows go from south to north, but the image's rows go from top to bottom.
        const at = 4 * ((map.heightPx - 1 - row) * map.widthPx + column);
        const share =
          value <= faintest ? 0 : Math.log(value / faintest) / Math.log(whitest / faintest);
        image.data.set([238, 236, 230, Math.round(255 * Math.min(1, share))], at);
      }
    }
    context.putImageData(image, 0, 0);
  }, [map]);
  const low = placeOnMap(extent, [map.low?.xM ?? 0, map.low?.yM ?? 0]);
  const high = placeOnMap(extent, [map.high?.xM ?? 0, map.high?.yM ?? 0]);
  const percent = (share: number) => `${(100 * share).toFixed(3)}%`;
  return (
    <canvas
      ref={canvas}
      width={map.widthPx}
      height={map.heightPx}
      style={{
        left: percent(low.right),
        top: percent(high.down),
        width: percent(high.right - low.right),
        height: percent(low.down - high.down),
      }}
    />
  );
}

function Lines({ lines, extent }: { lines: MapLines | undefined; extent: Extent }) {
  if (lines === undefined) return null;
  const scale = SIZE / (extent.eastM - extent.westM);
  return (
    <g
      class="map-lines"
      transform={`scale(${scale}) translate(${-extent.westM} ${extent.northM})`}
      data-testid="map-lines"
    >
      <path class="map-states" d={lines.states} />
      <path class="map-countries" d={lines.countries} />
    </g>
  );
}

function Domain(props: { state: PageState; extent: Extent; map: GetStormMapResponse | undefined }) {
  const domain = domainOf(props.map, props.state);
  return <Ground name="map-domain" part={domain} extent={props.extent} />;
}

// Draws a part of the ground as a rectangle of class `name`.
function Ground({ name, part, extent }: { name: string; part: Extent; extent: Extent }) {
  const corner = placeOnMap(extent, [part.westM, part.northM]);
  const other = placeOnMap(extent, [part.eastM, part.southM]);
  return (
    <rect
      class={name}
      x={SIZE * corner.right}
      y={SIZE * corner.down}
      width={SIZE * (other.right - corner.right)}
      height={SIZE * (other.down - corner.down)}
    />
  );
}

const WEDGE = 42;

function CameraOnMap({ state, extent }: { state: PageState; extent: Extent }) {
  const pose = state.viewPose.value;
  if (pose?.kind === "topDown") return <SeenFromAbove pose={pose} state={state} extent={extent} />;
  const stand = standOf(pose);
  if (stand === undefined) return null;
  const place = placeOnMap(extent, stand.placeM);
  // A camera that is far away is shown at the edge.
  const x = SIZE * Math.min(0.97, Math.max(0.03, place.right));
  const y = SIZE * Math.min(0.97, Math.max(0.03, place.down));
  const right = state.frame.value?.projection?.right;
  const half = right === undefined ? 0.4 : Math.atan(Math.hypot(...right));
  const look = (stand.lookDeg * Math.PI) / 180;
  const edge = (angle: number) =>
    `${x + WEDGE * Math.sin(look + angle)} ${y - WEDGE * Math.cos(look + angle)}`;
  const target =
    pose?.kind === "orbit" ? placeOnMap(extent, [pose.targetM[0], pose.targetM[1]]) : undefined;
  return (
    <>
      <path
        class="map-wedge"
        d={`M${x} ${y} L${edge(-half)} A${WEDGE} ${WEDGE} 0 0 1 ${edge(half)} Z`}
      />
      {target !== undefined && (
        <circle class="map-target" cx={SIZE * target.right} cy={SIZE * target.down} r={2} />
      )}
      <circle class="map-camera" cx={x} cy={y} r={2.2} data-testid="map-camera" />
    </>
  );
}

interface FromAbove {
  readonly pose: TopDownPose;
  readonly state: PageState;
  readonly extent: Extent;
}

// Draws the part of the ground that a picture from above shows.
function SeenFromAbove({ pose: { centerM, widthM }, state, extent }: FromAbove) {
  const { widthPx = 1, heightPx = 1 } = state.frame.value ?? {};
  const [halfWidthM, halfHeightM] = [widthM / 2, (widthM / 2) * (heightPx / widthPx)];
  const shown = {
    westM: centerM[0] - halfWidthM,
    eastM: centerM[0] + halfWidthM,
    southM: centerM[1] - halfHeightM,
    northM: centerM[1] + halfHeightM,
  };
  const middle = placeOnMap(extent, centerM);
  return (
    <>
      <Ground name="map-wedge" part={shown} extent={extent} />
      <circle
        class="map-camera"
        cx={SIZE * middle.right}
        cy={SIZE * middle.down}
        r={2.2}
        data-testid="map-camera"
      />
    </>
  );
}

// Draws an arrow to true north in the corner. The map's own up direction is the grid's north.
function North({ trueNorthDeg }: { trueNorthDeg: number }) {
  const angle = (trueNorthDeg * Math.PI) / 180;
  const [x, y] = [SIZE - 6, 8];
  const [dx, dy] = [Math.sin(angle), -Math.cos(angle)];
  return (
    <g data-testid="map-north">
      <line class="map-ray" x1={x - 4 * dx} y1={y - 4 * dy} x2={x + dx} y2={y + dy} />
      <text class="map-north" x={x + 4 * dx} y={y + 4 * dy}>
        N
      </text>
    </g>
  );
}

// Draws in the corner the direction from which the light comes.
function SunOnMap({ azimuthDeg }: { azimuthDeg: number }) {
  const azimuth = (azimuthDeg * Math.PI) / 180;
  const [x, y] = [88, 20];
  const [dx, dy] = [7 * Math.sin(azimuth), -7 * Math.cos(azimuth)];
  return (
    <>
      <line class="map-ray" x1={x + dx} y1={y + dy} x2={x - dx} y2={y - dy} />
      <circle class="map-sun" cx={x + dx} cy={y + dy} r={2.2} />
    </>
  );
}

function Cross({ right, down }: { right: number; down: number }) {
  const [x, y] = [SIZE * right, SIZE * down];
  return <path class="map-cross" d={`M${x - 4} ${y}h8M${x} ${y - 4}v8`} />;
}

function cameraPlace(pose: Pose | undefined): readonly [number, number] | undefined {
  return pose?.kind === "topDown" ? pose.centerM : standOf(pose)?.placeM;
}

interface ScaleBarProps {
  readonly extent: Extent;
  readonly cameraM: readonly [number, number] | undefined;
}

// Draws a scale bar in the lower left corner. If the camera is in the left part of the map, the bar
// is in the lower right corner.
function ScaleBar({ extent, cameraM }: ScaleBarProps) {
  const width = extent.eastM - extent.westM;
  const lengthM = roundLength(width / 4);
  const cameraLeft = cameraM !== undefined && placeOnMap(extent, cameraM).right < 0.5;
  const shift = cameraLeft ? SIZE - 8 - (SIZE * lengthM) / width : 0;
  return (
    <g class="map-scale" transform={`translate(${shift} 0)`} data-testid="map-scale">
      <line x1={4} y1={96} x2={4 + (SIZE * lengthM) / width} y2={96} />
      <text x={4} y={93.5}>
        {formatLength(lengthM, "distance")}
      </text>
    </g>
  );
}
