// The tool that sets the camera's position: the inset map, the kind of camera, positions by
// distance and direction, and named views.
import { create } from "@bufbuild/protobuf";
import { useState } from "preact/hooks";
import { placeFrom } from "../../core/map_frame";
import { nameOfHydrometeor } from "../../core/names";
import { compassPoint, gridAzimuthDeg } from "../../core/sun";
import { formatLength, lengthUnits } from "../../core/units";
import type { FieldMaximum } from "../../gen/thunderhead/v1/probe_pb";
import { type Camera, CameraSchema } from "../../gen/thunderhead/v1/scene_pb";
import { CameraControls } from "../camera_section";
import { Choice, NumberInput } from "../controls";
import type { Page } from "../page";
import { InsetMap } from "./inset_map";
import { NamedViews } from "./named_views";

export function MapTool({ page }: { page: Page }) {
  const { state } = page;
  return (
    <>
      <InsetMap
        state={state}
        steps={{
          stand: (placeM, lookDeg) => page.viewpoint.show(spotterAt(placeM, lookDeg)),
          turnAround: ([xM, yM]) => page.viewpoint.turnAround([xM, yM, undefined]),
        }}
      />
      {state.mapProblem.value !== undefined && (
        <p class="unmet" data-testid="map-problem">
          {state.mapProblem.value}
        </p>
      )}
      <CameraControls page={page} />
      <StandOff page={page} />
      <NamedViews page={page} />
    </>
  );
}

// Makes a camera on the ground. If `azimuthDeg` is undefined, the server chooses it, so that the
// camera looks at the storm.
function spotterAt([xM, yM]: readonly [number, number], azimuthDeg?: number): Camera {
  return create(CameraSchema, { kind: { case: "spotter", value: { xM, yM, azimuthDeg } } });
}

const DIRECTIONS = [0, 45, 90, 135, 180, 225, 270, 315].map(
  (azimuthDeg) => [azimuthDeg, compassPoint(azimuthDeg)] as const,
);
const MIDDLE = -1;

// Chooses a place such as "20 km SE of the graupel core".
function StandOff({ page }: { page: Page }) {
  const { state } = page;
  const cores = (state.stormMap.value?.maxima ?? []).filter(({ position }) => position);
  const [distance, setDistance] = useState(20);
  const [azimuthDeg, setAzimuth] = useState(135);
  const [of, setOf] = useState(MIDDLE);
  const unitM = lengthUnits.value === "aviation" ? 1852 : 1000;
  const from = (): readonly [number, number] => {
    const core = cores.find(({ hydrometeor }) => hydrometeor === of)?.position;
    return core === undefined ? [0, 0] : [core.xM, core.yM];
  };
  return (
    <details class="folded" data-testid="stand-off">
      <summary>Stand at a distance</summary>
      <NumberInput
        label={`Distance, ${unitM === 1000 ? "km" : "nm"}`}
        testId="stand-distance"
        value={distance}
        onChange={setDistance}
      />
      <Choice
        label="Direction"
        testId="stand-direction"
        value={azimuthDeg}
        options={DIRECTIONS}
        onChange={setAzimuth}
      />
      <Choice
        label="Of"
        testId="stand-of"
        value={of}
        options={[[MIDDLE, "the domain's middle"], ...cores.map(coreName)]}
        onChange={setOf}
      />
      <button
        type="button"
        data-testid="stand-there"
        onClick={() => {
          const towardsDeg = gridAzimuthDeg(azimuthDeg, state.trueNorthDeg.value);
          const placeM = placeFrom(from(), distance * unitM, towardsDeg);
          page.viewpoint.show(spotterAt(placeM, (towardsDeg + 180) % 360));
        }}
      >
        Stand there
      </button>
    </details>
  );
}

function coreName({ hydrometeor, position }: FieldMaximum): readonly [number, string] {
  const name = nameOfHydrometeor(hydrometeor).toLowerCase();
  const height = formatLength(position?.zM ?? 0, "height");
  return [hydrometeor, `the ${name} core, ${height} up`];
}
