// Draws pointers and marks over the picture. Their positions in the world are projected by the
// camera of the picture on the screen.

import { hexOfColor } from "../core/color";
import { inkOutline, type MarkStroke, markStrokes } from "../core/mark_strokes";
import type { Marking } from "../core/marking";
import { type Box, placeInBox } from "../core/picture_box";
import { type PicturePoint, type Projection, project, type Vec3 } from "../core/projection";
import type { PageState } from "../core/state";
import type { StrokePoint } from "../core/stroke";
import type { Mark, Pointer } from "../gen/thunderhead/v1/interact_pb";
import type { Position } from "../gen/thunderhead/v1/scene_pb";
import type { MarkedView } from "./compare/comparing";

interface OverlayProps {
  readonly state: PageState;
  readonly marking: Marking;
  readonly marked: MarkedView;
}

export function Overlay({ state, marking, marked }: OverlayProps) {
  const { session } = state;
  const box = state.pictureBox.value;
  const projection = state.frame.value?.projection;
  const stroke = marking.stroke.value;
  return (
    <svg class="overlay" data-testid="overlay" aria-hidden="true">
      {box !== undefined && projection !== undefined && (
        <g clip-path="url(#marked-view)">
          <clipPath id="marked-view">
            {marked === "picture" ? (
              <rect x={box.left} y={box.top} width={box.width} height={box.height} />
            ) : (
              <rect width={`${100 * marked}%`} height="100%" />
            )}
          </clipPath>
          {session.marks.value.map((mark) => (
            <MarkLine key={mark.markId} mark={mark} projection={projection} box={box} />
          ))}
          {session.pendingMarks.value.map((pending) => (
            <Line
              key={`pending-${pending.id}`}
              strokes={markStrokes(projection, pending.pointsM)}
              box={box}
              testId="pending-mark"
            />
          ))}
          {session.pointers.value.map((pointer) => (
            <PointerDot
              key={pointer.viewerId}
              pointer={pointer}
              name={session.isMe(pointer.viewerId) ? "" : session.nameOfId(pointer.viewerId)}
              projection={projection}
              box={box}
            />
          ))}
        </g>
      )}
      {box !== undefined && projection !== undefined && (
        <ProbeMarks state={state} projection={projection} box={box} />
      )}
      {stroke.length > 1 && (
        <g class="pending">
          <Ink places={stroke} />
        </g>
      )}
    </svg>
  );
}

// Shows the cross in the picture's middle, where a probe by keyboard measures, and the places that
// earlier probes have found.
function ProbeMarks({ state, projection, box }: InPicture & { state: PageState }) {
  if (state.tool.value !== "probe") return null;
  const places = state.probes.value.flatMap(({ found }) => {
    const at = found.seenPlace?.position;
    const point = at === undefined ? undefined : project(projection, pointOf(at));
    return point === undefined ? [] : [placeInBox(box, point)];
  });
  const [first, second] = places;
  const middle = placeInBox(box, { x: 0, y: 0 });
  return (
    <g data-testid="probe-marks">
      <path
        class="aim"
        d={`M${middle.left - 12} ${middle.top}h9m6 0h9M${middle.left} ${middle.top - 12}v9m0 6v9`}
      />
      {first !== undefined && second !== undefined && (
        <line class="probe-line" x1={first.left} y1={first.top} x2={second.left} y2={second.top} />
      )}
      {places.map(({ left, top }, at) => (
        <circle key={at} class="probed" cx={left} cy={top} r={7} />
      ))}
    </g>
  );
}

interface InPicture {
  readonly projection: Projection;
  readonly box: Box;
}

function MarkLine({ mark, projection, box }: InPicture & { mark: Mark }) {
  const strokes = markStrokes(projection, mark.positions.map(pointOf));
  const color = mark.color === undefined ? undefined : hexOfColor(mark.color);
  return <Line strokes={strokes} box={box} color={color} testId="mark" />;
}

interface LineProps {
  readonly strokes: readonly MarkStroke[];
  readonly box: Box;
  readonly color?: string | undefined;
  readonly testId: string;
}

function Line({ strokes, box, color, testId }: LineProps) {
  const style = color === undefined ? {} : { color };
  return (
    <g data-testid={testId} data-corners={cornersOf(strokes, box)} style={style}>
      {strokes.map((stroke, at) => {
        const places = stroke.points.map((point) => placeInBox(box, point));
        if (stroke.ink) return <Ink key={at} places={places} />;
        const points = places.map(({ left, top }) => `${left},${top}`).join(" ");
        return (
          <g key={at}>
            <polyline class="mark-edge" points={points} />
            <polyline class="mark" points={points} />
          </g>
        );
      })}
    </g>
  );
}

function Ink({ places }: { places: readonly StrokePoint[] }) {
  const path = inkOutline(places)
    .map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`)
    .join("L");
  return <path class="ink" d={`M${path}Z`} />;
}

function cornersOf(strokes: readonly MarkStroke[], box: Box): string {
  return strokes
    .flatMap(({ points }) => points)
    .map((point) => pathText(box, point))
    .join(" ");
}

function PointerDot(props: InPicture & { pointer: Pointer; name: string }) {
  const { pointer, name, projection, box } = props;
  if (pointer.position === undefined) return null;
  const point = project(projection, pointOf(pointer.position));
  if (point === undefined || Math.abs(point.x) > 1 || Math.abs(point.y) > 1) return null;
  const { left, top } = placeInBox(box, point);
  return (
    <g data-testid="pointer" transform={`translate(${left.toFixed(1)} ${top.toFixed(1)})`}>
      <circle class="pointer-halo" r={13} />
      <circle class="pointer-dot" r={6} />
      <text class="pointer-name" x={17} y={5}>
        {name}
      </text>
    </g>
  );
}

function pathText(box: Box, point: PicturePoint): string {
  const { left, top } = placeInBox(box, point);
  return `${left.toFixed(1)},${top.toFixed(1)}`;
}

function pointOf({ xM, yM, zM }: Position): Vec3 {
  return [xM, yM, zM];
}
