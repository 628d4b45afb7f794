// Title, time, scales and rings over the picture in the window, or in a picture that is saved.
import {
  type Annotated,
  type AnnotationChoice,
  annotationsOf,
  LETTER_PX,
  type LegendEntry,
  letterPxOf,
  type Shape,
  widthForPx,
} from "../core/annotations";
import type { Pose } from "../core/camera";
import { timeInWords } from "../core/moment";
import { nameOfHydrometeor } from "../core/names";
import type { Projection } from "../core/projection";
import { effectiveField } from "../core/scene";
import type { PageState } from "../core/state";
import type { StormTime } from "../gen/thunderhead/v1/storm_pb";

// Sizes of the areas at the window's edges that the page's own bars cover. TOP_WITH_NAMES_PX
// replaces `top` while two pictures are compared, because their names are below the bar.
const BARS_PX = { left: 76, top: 106, right: 0, bottom: 88 };
const TOP_WITH_NAMES_PX = 166;
// Size of the covered area at the left while a tool is open next to the rail, and of the area at
// the right while the drawer is open.
const TOOL_LEFT_PX = 374;
const DRAWER_RIGHT_PX = 344;
const NARROW_BARS_PX = { left: 0, top: 190, right: 0, bottom: 84 };
const NARROW_TOP_WITH_NAMES_PX = 236;
const SESSION_BAR_PX = 72;
const NARROW_PX = 900;
// If the window is lower than this, an open tool covers the picture instead of moving it.
const TALL_PX = 600;
// Minimum height between the bars for annotations, as a multiple of the letters' height.
const MIN_ROOM_LETTERS = 4;
// Maximum height of a tool at the bottom of a narrow window, relative to the window's height.
const SHEET_SHARE = 0.42;

export function Annotations(props: { state: PageState; comparing: boolean }) {
  const { state, comparing } = props;
  const box = state.pictureBox.value;
  const content = annotated(labelsOf(state), state.frame.value ?? {}, state.shownTime.value);
  if (box === undefined || content === undefined) return null;
  const narrow = window.innerWidth < NARROW_PX;
  // In a narrow window the drawer covers the picture, so there are no annotations.
  if (narrow && state.drawerOpen.value) return null;
  const bars = narrow ? narrowBars(state, comparing) : wideBars(state, comparing);
  // There are no annotations if too little of the picture is visible, for example on a phone in
  // landscape orientation.
  const leftPx = window.innerHeight - bars.top - bars.bottom;
  if (narrow && leftPx < MIN_ROOM_LETTERS * LETTER_PX) return null;
  const shapes = annotationsOf(
    {
      ...content,
      widthPx: box.width,
      heightPx: box.height,
      inset: {
        left: Math.max(0, bars.left - box.left),
        right: Math.max(0, bars.right - (window.innerWidth - box.left - box.width)),
        top: Math.max(0, bars.top - box.top),
        bottom: Math.max(0, bars.bottom - (window.innerHeight - box.top - box.height)),
      },
      letterPx: LETTER_PX,
    },
    // The annotations omit the title, because the top bar shows it.
    { ...state.annotations.value, title: false },
  );
  return (
    <svg class="annotations" data-testid="annotations" aria-hidden="true">
      <g transform={`translate(${box.left} ${box.top})`} font-size={LETTER_PX}>
        {shapes.map((shape, at) => (
          <Drawn key={at} shape={shape} />
        ))}
      </g>
    </svg>
  );
}

function narrowBars({ tool, session }: PageState, comparing: boolean) {
  const sheetPx = tool.value === undefined ? 0 : SHEET_SHARE * window.innerHeight;
  // If a tool is open at the bottom, the picture lies between the bars and the tool.
  const between = sheetPx > 0 && !comparing && window.innerHeight >= TALL_PX;
  const barsPx = comparing ? NARROW_TOP_WITH_NAMES_PX : NARROW_BARS_PX.top;
  const top = barsPx + (session.hasBar.value ? SESSION_BAR_PX : 0);
  return { ...NARROW_BARS_PX, top: between ? 0 : top, bottom: NARROW_BARS_PX.bottom + sheetPx };
}

function wideBars(state: PageState, comparing: boolean) {
  return {
    ...BARS_PX,
    top: comparing ? TOP_WITH_NAMES_PX : BARS_PX.top,
    left: state.tool.value === undefined ? BARS_PX.left : TOOL_LEFT_PX,
    right: state.drawerOpen.value ? DRAWER_RIGHT_PX : BARS_PX.right,
  };
}

function Drawn({ shape }: { shape: Shape }) {
  switch (shape.kind) {
    case "line":
      return (
        <polyline
          points={shape.points.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ")}
        />
      );
    case "text":
      return (
        <text
          x={shape.x}
          y={shape.y}
          text-anchor={shape.anchor}
          font-weight={shape.strong ? 700 : 500}
        >
          {shape.text}
        </text>
      );
    case "swatch":
      return (
        <rect
          x={shape.x}
          y={shape.y}
          width={shape.sizePx}
          height={shape.sizePx}
          fill={shape.color}
          stroke="none"
        />
      );
  }
}

type Content = Omit<Annotated, "widthPx" | "heightPx" | "inset" | "letterPx">;

// The parts of the annotations that do not depend on the picture's camera and time.
export interface Labels {
  readonly title: string;
  readonly times: readonly StormTime[];
  readonly trueNorthDeg: number;
  // Height of the ground above sea level.
  readonly groundM: number;
  readonly legend: readonly LegendEntry[];
}

// Returns the labels of the storm that is shown now. A movie keeps the labels of the moment when it
// was requested, because another storm may be shown before the movie is finished.
export function labelsOf(state: PageState): Labels {
  return {
    title: [state.title.value, state.run.value].filter((part) => part !== "").join(" · "),
    times: state.storm.value?.times ?? [],
    trueNorthDeg: state.trueNorthDeg.value,
    groundM: state.storm.value?.grid?.low?.zM ?? 0,
    legend: state.falseColorsShown.value ? legendOf(state) : [],
  };
}

// Returns the annotations of a picture with that camera and time; undefined without a camera.
export function annotated(
  { title, trueNorthDeg, groundM, legend }: Labels,
  { projection, pose }: { readonly projection?: Projection; readonly pose?: Pose },
  time: StormTime | undefined,
): Content | undefined {
  if (projection === undefined) return undefined;
  return { projection, pose, trueNorthDeg, groundM, title, time: timeInWords(time), legend };
}

function legendOf(state: PageState): LegendEntry[] {
  void state.fields.value;
  return (state.storm.value?.fields ?? []).flatMap(({ hydrometeor, defaults }) => {
    if (effectiveField(state.scene.peek(), hydrometeor, defaults).visible === false) return [];
    return [{ name: nameOfHydrometeor(hydrometeor), color: state.colorOf(hydrometeor) }];
  });
}

type Context = CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D;

// Draws the annotations into a picture. Relative to the picture, they are as large as in a window.
export function drawAnnotations(
  context: Context,
  content: Content,
  choice: AnnotationChoice,
  { width, height }: { readonly width: number; readonly height: number },
): void {
  const letterPx = letterPxOf(width, height);
  const inset = { left: 0, top: 0, right: 0, bottom: 0 };
  const picture = { ...content, widthPx: width, heightPx: height, inset, letterPx };
  context.lineJoin = "round";
  for (const shape of annotationsOf(picture, choice)) drawShape(context, shape, picture);
}

function drawShape(context: Context, shape: Shape, picture: Annotated): void {
  const { letterPx, widthPx } = picture;
  const shadow = "rgb(0 0 0 / 65%)";
  switch (shape.kind) {
    case "line":
      context.beginPath();
      for (const [x, y] of shape.points) context.lineTo(x, y);
      context.strokeStyle = shadow;
      context.lineWidth = letterPx / 4;
      context.stroke();
      context.strokeStyle = "#fff";
      context.lineWidth = letterPx / 10;
      context.stroke();
      break;
    case "text": {
      context.font = `${shape.strong ? 700 : 500} ${letterPx}px system-ui, "DejaVu Sans", sans-serif`;
      context.textAlign = shape.anchor === "middle" ? "center" : shape.anchor;
      context.strokeStyle = shadow;
      context.lineWidth = letterPx / 4;
      context.fillStyle = "#fff";
      const mostPx = Math.max(1, widthForPx(shape, widthPx, letterPx));
      context.strokeText(shape.text, shape.x, shape.y, mostPx);
      context.fillText(shape.text, shape.x, shape.y, mostPx);
      break;
    }
    case "swatch":
      context.fillStyle = shape.color;
      context.fillRect(shape.x, shape.y, shape.sizePx, shape.sizePx);
      break;
  }
}
