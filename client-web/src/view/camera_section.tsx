// Controls for the kind of camera, its position and its direction.
import {
  type CameraKind,
  type Pose,
  SPOTTER_LIMITS,
  type SpotterPose,
  TOP_DOWN_LIMITS,
  type TopDownPose,
} from "../core/camera";
import { gridAzimuthDeg, trueAzimuthDeg } from "../core/sun";
import { describePose } from "../core/words";
import { Segments, Slider } from "./controls";
import type { Page } from "./page";

const KINDS: readonly (readonly [CameraKind, string, string])[] = [
  ["orbit", "Around", "Turns around a target in the storm."],
  ["spotter", "From the ground", "Stands on the ground, as a spotter does."],
  ["topDown", "From above", "Looks straight down, as satellite pictures do."],
];

export function CameraControls({ page }: { page: Page }) {
  const { state } = page;
  const pose = state.viewPose.value;
  const trueNorthDeg = state.trueNorthDeg.value;
  const kind = pose?.kind ?? state.cameraKind.value;
  const change = (part: Partial<SpotterPose> | Partial<TopDownPose>) =>
    page.move((now) => ({ ...now, ...part }) as Pose);
  return (
    <>
      <Segments
        label="Camera"
        testId="camera-kind"
        value={kind}
        options={KINDS}
        otherwise=""
        onChange={(chosen) => page.showCamera(chosen)}
      />
      <p class="quiet" data-testid="camera">
        {describePose(pose, trueNorthDeg)}
      </p>
      {pose?.kind === "spotter" && (
        <SpotterControls pose={pose} trueNorthDeg={trueNorthDeg} onChange={change} />
      )}
      {pose?.kind === "topDown" && <TopDownControls pose={pose} onChange={change} />}
      <div class="buttons">
        <button type="button" data-testid="home" onClick={() => page.home()}>
          Whole storm
        </button>
      </div>
    </>
  );
}

interface ControlsProps<P> {
  readonly pose: P;
  readonly onChange: (change: Partial<P>) => void;
}

interface SpotterProps extends ControlsProps<SpotterPose> {
  readonly trueNorthDeg: number;
}

function SpotterControls({ pose, trueNorthDeg, onChange }: SpotterProps) {
  const [x, y] = pose.placeM;
  return (
    <>
      <Slider
        label="East"
        limits={SPOTTER_LIMITS.x}
        value={pose.placeM[0]}
        testId="spotter-x"
        onChange={(xM) => onChange({ placeM: [xM, y] })}
      />
      <Slider
        label="North"
        limits={SPOTTER_LIMITS.y}
        value={pose.placeM[1]}
        testId="spotter-y"
        onChange={(yM) => onChange({ placeM: [x, yM] })}
      />
      <Slider
        label="Eye height"
        limits={SPOTTER_LIMITS.eyeHeight}
        value={pose.eyeHeightM}
        testId="spotter-eye-height"
        onChange={(eyeHeightM) => onChange({ eyeHeightM })}
      />
      <Slider
        label="Looks to"
        limits={SPOTTER_LIMITS.azimuth}
        value={trueAzimuthDeg(pose.azimuthDeg, trueNorthDeg)}
        testId="spotter-azimuth"
        onChange={(deg) => onChange({ azimuthDeg: gridAzimuthDeg(deg, trueNorthDeg) })}
      />
      <Slider
        label="Looks up"
        limits={SPOTTER_LIMITS.elevation}
        value={pose.elevationDeg}
        testId="spotter-elevation"
        onChange={(elevationDeg) => onChange({ elevationDeg })}
      />
      <Slider
        label="Focal length"
        limits={SPOTTER_LIMITS.focalLength}
        value={pose.focalLengthMm}
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
      value={pose.widthM}
      testId="top-down-width"
      onChange={(widthM) => onChange({ widthM })}
    />
  );
}
