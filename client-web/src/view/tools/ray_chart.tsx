// A chart of the fields along a ray. uPlot is loaded with the first chart.
import { useEffect, useRef } from "preact/hooks";
import { nameOfHydrometeor } from "../../core/names";
import { readable } from "../../core/probe";
import type { PageState } from "../../core/state";
import { formatNumber, lengthUnits } from "../../core/units";
import type { FieldAlongRay, ProbeRayResponse } from "../../gen/thunderhead/v1/probe_pb";
import { withPart } from "../part";

const HEIGHT_PX = 170;

function valueInWords(value: number | null, units: string): string {
  // The value is null while the pointer is not on the chart.
  return value === null ? "" : `${formatNumber(value)} ${readable(units).symbol}`;
}

function unitOfFields(fields: readonly FieldAlongRay[]): string {
  return [...new Set(fields.map(({ units }) => readable(units).symbol))].join(", ");
}

export function RayChart({ state, found }: { state: PageState; found: ProbeRayResponse }) {
  const place = useRef<HTMLDivElement>(null);
  const nautical = lengthUnits.value === "aviation";
  const colors = found.fields.map(({ hydrometeor }) => state.colorOf(hydrometeor)).join(" ");
  useEffect(() => {
    let chart: { destroy(): void } | undefined;
    let wanted = true;
    withPart(
      state,
      "The chart",
      () => Promise.all([import("uplot"), import("uplot/dist/uPlot.min.css")]),
      ([{ default: UPlot }]) => {
        if (!wanted || place.current === null) return;
        const fields = found.fields.filter(({ values }) => values.length > 0);
        const unit = nautical ? { metres: 1852, symbol: "nm" } : { metres: 1000, symbol: "km" };
        const axis = {
          stroke: "#a9b5c4",
          grid: { stroke: "rgb(255 255 255 / 8%)" },
          font: "11px system-ui",
        };
        chart = new UPlot(
          {
            width: place.current.clientWidth,
            height: HEIGHT_PX,
            // The legend shows the values under the pointer.
            legend: { live: true },
            cursor: { y: false },
            scales: { x: { time: false } },
            axes: [
              {
                ...axis,
                label: `away, ${unit.symbol}`,
                labelSize: 18,
                labelFont: "11px system-ui",
                size: 28,
              },
              {
                ...axis,
                label: unitOfFields(fields),
                labelSize: 18,
                labelFont: "11px system-ui",
                size: 38,
              },
            ],
            series: [
              {
                label: "away",
                value: (_, away) => (away === null ? "" : `${formatNumber(away)} ${unit.symbol}`),
              },
              ...fields.map(({ hydrometeor, units }) => ({
                label: nameOfHydrometeor(hydrometeor),
                value: (_: unknown, value: number | null) => valueInWords(value, units),
                stroke: state.colorOf(hydrometeor),
                width: 1.5,
                points: { show: false },
              })),
            ],
          },
          [
            found.distancesM.map((metres) => metres / unit.metres),
            ...fields.map(({ values, units }) =>
              values.map((value) => value * readable(units).factor),
            ),
          ],
          place.current,
        );
      },
    );
    return () => {
      wanted = false;
      chart?.destroy();
    };
  }, [state, found, nautical, colors]);
  return (
    <div
      ref={place}
      class="ray-chart"
      role="img"
      aria-label="The fields along the ray, by distance; the table above has their largest values"
      data-testid="ray-chart"
    />
  );
}
