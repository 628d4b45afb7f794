// The probe tool. A click on the picture asks the server for the place in the storm that is seen
// there, and for the values of every field along the ray.

import { nameOfHydrometeor } from "../../core/names";
import { displacementBetween, type Probed, placeInWords, readable } from "../../core/probe";
import type { PageState } from "../../core/state";
import { compassPoint, trueAzimuthDeg } from "../../core/sun";
import { formatLength, formatNumber } from "../../core/units";
import {
  type FieldAlongRay,
  type FieldMaximum,
  type ProbeRayResponse,
  type RayPlace,
  ProbeRayResponse_Seen as Seen,
} from "../../gen/thunderhead/v1/probe_pb";
import type { Page } from "../page";
import { RayChart } from "./ray_chart";

export function ProbeTool({ page }: { page: Page }) {
  const { state } = page;
  const last = state.probes.value.at(-1);
  return (
    <>
      <p class="quiet">
        Click a point in the picture to see what is there. A second click measures from the first.
        With the keyboard, turn the picture until the cross is on the point, then press Enter.
      </p>
      <div class="buttons">
        <button
          type="button"
          data-testid="probe-middle"
          disabled={state.probing.value || state.frame.value === undefined}
          onClick={() => void page.probing.through({ x: 0, y: 0 })}
        >
          {state.probing.value ? "Asking …" : "Probe the middle"}
        </button>
        {last !== undefined && (
          <button type="button" data-testid="probe-forget" onClick={() => page.probing.forget()}>
            Clear
          </button>
        )}
      </div>
      {state.probeProblem.value !== undefined && (
        <p class="unmet" role="alert" data-testid="probe-problem">
          {state.probeProblem.value}
        </p>
      )}
      <div aria-live="polite">{last !== undefined && <Found state={state} last={last} />}</div>
      <Cores page={page} />
    </>
  );
}

function Found({ state, last }: { state: PageState; last: Probed }) {
  const { found } = last;
  const [first, second] = state.probes.value;
  const displacement =
    first?.stormId === second?.stormId
      ? displacementBetween(first?.found.seenPlace, second?.found.seenPlace)
      : undefined;
  const towardsDeg = trueAzimuthDeg(displacement?.azimuthDeg ?? 0, state.trueNorthDeg.value);
  return (
    <section aria-label="Found" data-testid="probe-found">
      <p class="found">
        {last.picture === "B" && <span data-testid="probe-picture">B · </span>}
        <strong>{seenInWords(found)}</strong>
        {found.seenPlace !== undefined && <Where place={found.seenPlace} />}
      </p>
      {displacement !== undefined && (
        <p data-testid="probe-displacement">
          From the first click: {formatLength(displacement.distanceM, "distance")} to{" "}
          {compassPoint(towardsDeg)} ({Math.round(towardsDeg)}°),{" "}
          {formatLength(Math.abs(displacement.heightM), "height")}{" "}
          {displacement.heightM < 0 ? "lower" : "higher"}
        </p>
      )}
      <table class="probe-fields" data-testid="probe-fields">
        <caption class="visually-hidden">The largest value of each field along the ray</caption>
        <thead>
          <tr>
            <th scope="col">Field</th>
            <th scope="col">Most</th>
            <th scope="col">Above sea</th>
          </tr>
        </thead>
        <tbody>
          {found.fields.map((field) => (
            <FieldRow key={field.variable} state={state} field={field} />
          ))}
        </tbody>
      </table>
      {found.distancesM.length > 1 && <RayChart state={state} found={found} />}
      <p class="quiet" data-testid="probe-depth">
        Optical depth {formatNumber(found.opticalDepth)}
        {found.firstCloud !== undefined &&
          `; cloud begins ${formatLength(found.firstCloud.distanceM, "distance")} away`}
        {found.depthOne !== undefined &&
          found.firstCloud !== undefined &&
          `, optical depth 1 after ${formatLength(found.depthOne.distanceM - found.firstCloud.distanceM, "distance")} in it`}
      </p>
    </section>
  );
}

function seenInWords({ seen }: ProbeRayResponse): string {
  if (seen === Seen.CLOUD) return "Cloud";
  return seen === Seen.GROUND ? "Ground" : "Sky: no cloud on this ray";
}

function Where({ place }: { place: RayPlace }) {
  const { earth } = place;
  return (
    <span data-testid="probe-place">
      {" "}
      {formatLength(place.heightM, "height")} above sea ·{" "}
      {formatLength(place.distanceM, "distance")} away
      {earth !== undefined && ` · ${placeInWords(earth.latitudeDeg, earth.longitudeDeg)}`}
    </span>
  );
}

function FieldRow({ state, field }: { state: PageState; field: FieldAlongRay }) {
  const { factor, symbol } = readable(field.units);
  return (
    <tr data-testid={`probe-${nameOfHydrometeor(field.hydrometeor).toLowerCase()}`}>
      <th scope="row">
        <span class="key-swatch" style={{ background: state.colorOf(field.hydrometeor) }} />
        {nameOfHydrometeor(field.hydrometeor)}
      </th>
      <td>
        {amount(field.maximum * factor)} {symbol}
      </td>
      <td>
        {field.maximumPlace === undefined
          ? "–"
          : formatLength(field.maximumPlace.heightM, "height")}
      </td>
    </tr>
  );
}

// Values below this are shown as "< 0.001", because models leave traces of condensate in clear air.
const LEAST = 0.001;

function amount(value: number): string {
  return value > 0 && value < LEAST ? `< ${LEAST}` : formatNumber(value);
}

// Buttons for the places where each field has its maximum in the whole storm. A click makes the
// camera turn around that place.
function Cores({ page }: { page: Page }) {
  const { state } = page;
  const map = state.stormMap.value;
  const problem = state.mapProblem.value;
  if (map === undefined && problem !== undefined)
    return (
      <p class="unmet" role="alert" data-testid="cores-problem">
        {problem}
      </p>
    );
  const time = state.timeIndex.value;
  const cores = (map?.maxima ?? []).filter(({ position }) => position);
  if (cores.length === 0) return null;
  return (
    <section aria-label="Cores" class="cores" data-testid="cores">
      <h3>Strongest in the storm, and its height above sea</h3>
      <ul>
        {cores.map((core) => (
          <Core key={core.variable} page={page} core={core} old={map?.timeIndex !== time} />
        ))}
      </ul>
    </section>
  );
}

interface CoreProps {
  readonly page: Page;
  readonly core: FieldMaximum;
  // True while the core (the place of the field's maximum) belongs to the previously shown time,
  // until the answer for this time arrives.
  readonly old: boolean;
}

function Core({ page, core, old }: CoreProps) {
  const { factor, symbol } = readable(core.units);
  const name = nameOfHydrometeor(core.hydrometeor);
  const { position } = core;
  return (
    <li>
      <button
        type="button"
        data-testid={`core-${name.toLowerCase()}`}
        title="Turn around this place"
        disabled={old}
        onClick={() => {
          if (position !== undefined)
            page.viewpoint.turnAround([position.xM, position.yM, position.zM]);
        }}
      >
        <span class="key-swatch" style={{ background: page.state.colorOf(core.hydrometeor) }} />
        {name} {formatNumber(core.value * factor)} {symbol},{" "}
        {formatLength(position?.zM ?? 0, "height")}
      </button>
    </li>
  );
}
