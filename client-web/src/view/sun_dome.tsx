// The sky dome: a disc with a sun that can be dragged. The disc's centre is the zenith, and the
// ring is the horizon. The wedge shows the camera's direction. The grid's north is up, as on the
// map, and the letters show the true directions.

import { wrapDegrees } from "../core/camera";
import { clampToLimits } from "../core/limits";
import { LIMITS } from "../core/scene";
import {
  compassPoint,
  DOME_HORIZON,
  domePointOfSun,
  type SunDirection,
  sunOfDomePoint,
  trueAzimuthDeg,
} from "../core/sun";

interface SunDomeProps {
  readonly sun: SunDirection;
  // The direction of true north, clockwise from the grid's north.
  readonly trueNorthDeg: number;
  // Azimuth of the camera's position, seen from the storm.
  readonly cameraAzimuthDeg: number | undefined;
  readonly disabled: boolean;
  readonly onChange: (sun: SunDirection) => void;
}

const RADIUS = 62;
const CENTER = 70;
const STEP_DEG = 5;
const FINE_STEP_DEG = 1;

export function SunDome(props: SunDomeProps) {
  const { sun, trueNorthDeg, cameraAzimuthDeg, disabled, onChange } = props;
  const point = domePointOfSun(sun);
  const x = CENTER + point.right * RADIUS;
  const y = CENTER + point.down * RADIUS;
  const trueDeg = trueAzimuthDeg(sun.azimuthDeg, trueNorthDeg);
  const text = `${Math.round(wrapDegrees(trueDeg))}° ${compassPoint(trueDeg)}, ${Math.round(sun.elevationDeg)}° above the horizon`;

  const drag = (event: PointerEvent & { currentTarget: HTMLDivElement }) => {
    if (disabled) return;
    const box = event.currentTarget.getBoundingClientRect();
    const scale = (2 * CENTER) / box.width;
    const right = ((event.clientX - box.left) * scale - CENTER) / RADIUS;
    const down = ((event.clientY - box.top) * scale - CENTER) / RADIUS;
    onChange(roundedToTenths(sunOfDomePoint(right, down)));
  };

  const key = (event: KeyboardEvent) => {
    const step = event.shiftKey ? FINE_STEP_DEG : STEP_DEG;
    const turns: Record<string, readonly [number, number]> = {
      ArrowLeft: [-step, 0],
      ArrowRight: [step, 0],
      ArrowUp: [0, step],
      ArrowDown: [0, -step],
    };
    const by = turns[event.key];
    if (by === undefined || disabled) return;
    event.preventDefault();
    onChange({
      azimuthDeg: wrapDegrees(sun.azimuthDeg + by[0]),
      elevationDeg: clampToLimits(sun.elevationDeg + by[1], LIMITS.sunElevation),
    });
  };

  return (
    <div
      class={disabled ? "dome off" : "dome"}
      role="slider"
      tabIndex={disabled ? -1 : 0}
      aria-disabled={disabled}
      aria-label="Direction of the sun: left and right turn it, up and down raise and lower it"
      aria-valuemin={LIMITS.sunElevation.minimum}
      aria-valuemax={LIMITS.sunElevation.maximum}
      aria-valuenow={Math.round(sun.elevationDeg)}
      aria-valuetext={text}
      data-testid="sun-dome"
      onKeyDown={key}
      onPointerDown={(event) => {
        event.currentTarget.setPointerCapture(event.pointerId);
        drag(event);
      }}
      onPointerMove={(event) => {
        if (event.currentTarget.hasPointerCapture(event.pointerId)) drag(event);
      }}
    >
      <svg viewBox={`0 0 ${2 * CENTER} ${2 * CENTER}`} aria-hidden="true">
        <circle class="dome-below" cx={CENTER} cy={CENTER} r={RADIUS} />
        <circle class="dome-sky" cx={CENTER} cy={CENTER} r={RADIUS * DOME_HORIZON} />
        <circle class="dome-ring" cx={CENTER} cy={CENTER} r={(RADIUS * DOME_HORIZON * 2) / 3} />
        <circle class="dome-ring" cx={CENTER} cy={CENTER} r={(RADIUS * DOME_HORIZON) / 3} />
        {cameraAzimuthDeg !== undefined && (
          <path
            class="dome-camera"
            d={`M${CENTER} ${CENTER} L${CENTER - 16} ${CENTER - RADIUS * DOME_HORIZON} L${CENTER + 16} ${CENTER - RADIUS * DOME_HORIZON} Z`}
            transform={`rotate(${cameraAzimuthDeg + 180} ${CENTER} ${CENTER})`}
          />
        )}
        {(["N", "E", "S", "W"] as const).map((name, quarter) => (
          <text
            key={name}
            class="dome-name"
            x={CENTER + Math.sin(radians(90 * quarter + trueNorthDeg)) * (RADIUS - 5)}
            y={CENTER - Math.cos(radians(90 * quarter + trueNorthDeg)) * (RADIUS - 5)}
          >
            {name}
          </text>
        ))}
        <line class="dome-ray" x1={CENTER} y1={CENTER} x2={x} y2={y} />
        <circle class={sun.elevationDeg < 0 ? "dome-sun set" : "dome-sun"} cx={x} cy={y} r={7} />
      </svg>
    </div>
  );
}

function radians(degrees: number): number {
  return (degrees * Math.PI) / 180;
}

function roundedToTenths(sun: SunDirection): SunDirection {
  return {
    azimuthDeg: Math.round(sun.azimuthDeg * 10) / 10,
    elevationDeg: Math.round(sun.elevationDeg * 10) / 10,
  };
}
