// Which camera, where it stands and where it looks.
import {
  type CameraKind,
  type Pose,
  SPOTTER_LIMITS,
  type SpotterPose,
  TOP_DOWN_LIMITS,
  type TopDownPose,
  wrapDegrees,
} from "../core/camera";
import { compassPoint } from "../core/sun";
import { formatNumber } from "../core/units";
import { Choice, Section, Slider } from "./controls";
import type { Page } from "./page";

const KINDS: readonly (readonly [CameraKind, string])[] = [
  ["orbit", "Around the storm"],
  ["spotter", "Spotter on the ground"],
  ["topDown", "From above"],
];

export function CameraSection({ page }: { page: Page }) {
  const { state } = page;
  const pose = state.pose.value;
  const kind = state.cameraKind.value;
  return (
    <Section title="Camera" open testId="camera-section">
      <Choice
        label="Camera"
        testId="camera-kind"
        value={kind}
        options={KINDS}
        onChange={(chosen) => page.showCamera(chosen)}
      />
      <p class="quiet" data-testid="camera">
        {describe(pose)}
      </p>
      {kind === "spotter" && (
        <SpotterControls
          pose={pose?.kind === "spotter" ? pose : undefined}
          onChange={(change) => state.move((now) => ({ ...now, ...change }) as Pose)}
        />
      )}
      {kind === "topDown" && (
        <TopDownControls
          pose={pose?.kind === "topDown" ? pose : undefined}
          onChange={(change) => state.move((now) => ({ ...now, ...change }) as Pose)}
        />
      )}
    </Section>
  );
}

function describe(pose: Pose | undefined): string {
  switch (pose?.kind) {
    case "orbit":
      return (
        `Seen from ${compassPoint(pose.azimuthDeg)} (${Math.round(wrapDegrees(pose.azimuthDeg))}°), ` +
        `${Math.round(pose.elevationDeg)}° high, ${formatNumber(pose.distanceM / 1000)} km away`
      );
    case "spotter":
      return (
        `Looks to ${compassPoint(pose.azimuthDeg)} (${Math.round(wrapDegrees(pose.azimuthDeg))}°), ` +
        `${Math.round(pose.elevationDeg)}° up, through a lens of ${formatNumber(pose.focalLengthMm)} mm`
      );
    case "topDown":
      return `${formatNumber(pose.widthM / 1000)} km from left to right, north up`;
    default:
      return "Waiting for the first picture …";
  }
}

interface ControlsProps<P> {
  readonly pose: P | undefined;
  readonly onChange: (change: Partial<P>) => void;
}

function SpotterControls({ pose, onChange }: ControlsProps<SpotterPose>) {
  const [x, y] = pose?.placeM ?? [0, 0];
  return (
    <>
      <Slider
        label="East"
        limits={SPOTTER_LIMITS.x}
        value={pose?.placeM[0]}
        testId="spotter-x"
        onChange={(xM) => onChange({ placeM: [xM, y] })}
      />
      <Slider
        label="North"
        limits={SPOTTER_LIMITS.y}
        value={pose?.placeM[1]}
        testId="spotter-y"
        onChange={(yM) => onChange({ placeM: [x, yM] })}
      />
      <Slider
        label="Eye height"
        limits={SPOTTER_LIMITS.eyeHeight}
        value={pose?.eyeHeightM}
        testId="spotter-eye-height"
        onChange={(eyeHeightM) => onChange({ eyeHeightM })}
      />
      <Slider
        label="Looks to"
        limits={SPOTTER_LIMITS.azimuth}
        value={pose?.azimuthDeg}
        testId="spotter-azimuth"
        onChange={(azimuthDeg) => onChange({ azimuthDeg })}
      />
      <Slider
        label="Looks up"
        limits={SPOTTER_LIMITS.elevation}
        value={pose?.elevationDeg}
        testId="spotter-elevation"
        onChange={(elevationDeg) => onChange({ elevationDeg })}
      />
      <Slider
        label="Focal length"
        limits={SPOTTER_LIMITS.focalLength}
        value={pose?.focalLengthMm}
        testId="spotter-focal-length"
        onChange={(focalLengthMm) => onChange({ focalLengthMm })}
      />
    </>
  );
}

function TopDownControls({ pose, onChange }: ControlsProps<TopDownPose>) {
  return (
    <Slider
      label="Width"
      limits={TOP_DOWN_LIMITS.width}
      value={pose?.widthM}
      testId="top-down-width"
      onChange={(widthM) => onChange({ widthM })}
    />
  );
}
