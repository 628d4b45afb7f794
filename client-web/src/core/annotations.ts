// Texts, scales and rings over a picture: title, valid time, legend, scale bar, degrees along the
// horizon, distance rings. The shapes are in pixels of the picture, and their positions follow from
// the frame's own camera. The window and saved files draw the same shapes.
import { type Pose, wrapDegrees } from "./camera";
import { type PicturePoint, type Projection, project, projectLine, type Vec3 } from "./projection";
import { compassPoint, trueAzimuthDeg } from "./sun";
import { formatLength, roundLength } from "./units";

export interface AnnotationChoice {
  readonly title: boolean;
  readonly time: boolean;
  readonly legend: boolean;
  readonly scale: boolean;
  readonly compass: boolean;
  readonly rings: boolean;
  // Whether saved files contain the people's marks. The window always shows them.
  readonly marks: boolean;
}

export const FIRST_ANNOTATIONS: AnnotationChoice = {
  title: true,
  time: true,
  legend: true,
  scale: true,
  compass: true,
  rings: false,
  marks: true,
};

export interface LegendEntry {
  readonly name: string;
  // A colour like "#rrggbb".
  readonly color: string;
}

export interface Annotated {
  readonly widthPx: number;
  readonly heightPx: number;
  // Number of pixels at each side of the picture that other parts of the page cover.
  readonly inset: Readonly<Record<"left" | "top" | "right" | "bottom", number>>;
  // Height of the letters.
  readonly letterPx: number;
  readonly projection: Projection;
  readonly pose: Pose | undefined;
  // The direction of true north in the scene, clockwise from the grid's north. The horizon's
  // degrees count from true north.
  readonly trueNorthDeg: number;
  // Height of the ground above sea level.
  readonly groundM: number;
  readonly title: string;
  readonly time: string;
  // The legend is empty unless the picture has false colours.
  readonly legend: readonly LegendEntry[];
}

export interface TextShape {
  readonly kind: "text";
  readonly x: number;
  readonly y: number;
  readonly anchor: "start" | "middle" | "end";
  readonly text: string;
  readonly strong: boolean;
}

export type Shape =
  | { readonly kind: "line"; readonly points: readonly (readonly [number, number])[] }
  | TextShape
  | {
      readonly kind: "swatch";
      readonly x: number;
      readonly y: number;
      readonly sizePx: number;
      readonly color: string;
    };

// Height of the letters in a window.
export const LETTER_PX = 13;

// Returns the height of the letters in an image file. Relative to the picture, the letters are as
// large as in a window on a desktop or a phone.
export function letterPxOf(widthPx: number, heightPx: number): number {
  return Math.max(11, Math.round(Math.min(heightPx / 45, widthPx / 30)));
}

// Returns the maximum width of a text in the picture. A wider text is compressed to this width.
export function widthForPx({ x, anchor }: TextShape, widthPx: number, letterPx: number): number {
  const [left, right] = [x - letterPx, widthPx - letterPx - x];
  if (anchor === "start") return right;
  return anchor === "end" ? left : 2 * Math.min(left, right);
}

const FAR_M = 1e7;
const RING_CORNERS = 96;
const MAX_RINGS = 5;

// Average width of a letter in a usual font, divided by its height.
const WIDTH_OF_LETTER = 0.65;

// Returns the shapes of all chosen annotations. Leaves out a text that would overlap an earlier
// one, such as an azimuth on the horizon or the distance of a ring.
export function annotationsOf(picture: Annotated, choice: AnnotationChoice): Shape[] {
  const { inset, letterPx } = picture;
  const left = inset.left + letterPx;
  const shapes: Shape[] = [];
  if (choice.title && picture.title !== "")
    shapes.push(text(left, inset.top + 1.6 * letterPx, picture.title, "start", true));
  if (choice.time && picture.time !== "")
    shapes.push(text(left, timeLineY(picture), picture.time, "start", true));
  if (choice.legend) shapes.push(...legend(picture));
  if (choice.scale) shapes.push(...scaleBar(picture));
  if (choice.compass) shapes.push(...horizon(picture));
  if (choice.rings) shapes.push(...rings(picture));
  return shapes.filter((shape, at) => isClear(shape, shapes.slice(0, at), letterPx));
}

function timeLineY({ heightPx, inset, letterPx }: Annotated): number {
  return heightPx - inset.bottom - 0.8 * letterPx;
}

function isClear(shape: Shape, before: readonly Shape[], letterPx: number): boolean {
  if (shape.kind !== "text") return true;
  const own = roomOf(shape, letterPx);
  return before.every((other) => {
    if (other.kind !== "text") return true;
    const { left, right, top, bottom } = roomOf(other, letterPx);
    return own.right <= left || right <= own.left || own.bottom <= top || bottom <= own.top;
  });
}

function roomOf({ x, y, anchor, text: { length } }: TextShape, letterPx: number) {
  const widthPx = WIDTH_OF_LETTER * letterPx * length;
  const left = { start: x, middle: x - widthPx / 2, end: x - widthPx }[anchor];
  return { left, right: left + widthPx, top: y - letterPx, bottom: y + 0.25 * letterPx };
}

function text(
  x: number,
  y: number,
  words: string,
  anchor: "start" | "middle" | "end",
  strong = false,
): Shape {
  return { kind: "text", x, y, anchor, text: words, strong };
}

function at(picture: Annotated, { x, y }: PicturePoint): readonly [number, number] {
  return [((x + 1) / 2) * picture.widthPx, ((1 - y) / 2) * picture.heightPx];
}

// Returns the legend. If the picture is too low for all rows, the legend continues in another
// column to the left.
function legend({ legend: entries, inset, letterPx, widthPx, heightPx }: Annotated): Shape[] {
  const rowPx = 1.5 * letterPx;
  const roomPx = heightPx - inset.top - inset.bottom - 0.5 * letterPx;
  const rows = Math.max(1, Math.floor(roomPx / rowPx));
  const longest = Math.max(...entries.map(({ name }) => name.length));
  const columnPx = (WIDTH_OF_LETTER * longest + 2.5) * letterPx;
  return entries.flatMap(({ name, color }, at): Shape[] => {
    const right = widthPx - inset.right - letterPx - Math.floor(at / rows) * columnPx;
    const y = inset.top + 1.6 * letterPx + (at % rows) * rowPx;
    return [
      { kind: "swatch", x: right - letterPx, y: y - 0.85 * letterPx, sizePx: letterPx, color },
      text(right - 1.5 * letterPx, y, name, "end"),
    ];
  });
}

// Returns the metres per pixel in the middle of the picture, at the target's distance. Returns
// undefined without a camera, and for a spotter, because its scale depends on the distance.
function metresPerPixel({ pose, projection, widthPx }: Annotated): number | undefined {
  if (pose?.kind === "topDown") return pose.widthM / widthPx;
  if (pose?.kind !== "orbit") return undefined;
  return (2 * Math.hypot(...projection.right) * pose.distanceM) / widthPx;
}

function scaleBar(picture: Annotated): Shape[] {
  const metres = metresPerPixel(picture);
  if (metres === undefined) return [];
  const { widthPx, heightPx, inset, letterPx } = picture;
  const lengthM = roundLength((metres * widthPx) / 6);
  const right = widthPx - inset.right - letterPx;
  const y = heightPx - inset.bottom - letterPx;
  const left = right - lengthM / metres;
  const up = letterPx / 2;
  const words = `${formatLength(lengthM, "distance")}${picture.pose?.kind === "orbit" ? " at the target" : ""}`;
  return [
    {
      kind: "line",
      points: [
        [left, y - up],
        [left, y],
        [right, y],
        [right, y - up],
      ],
    },
    // The text is above the bar's ends, because a long text extends over them, for example on a
    // phone.
    text(right, y - letterPx, words, "end"),
  ];
}

// Returns the degrees between ticks, such that about ten ticks are in view.
function tickStepDeg(viewDeg: number): number {
  return [1, 2, 5, 10, 15, 30].find((step) => viewDeg / step <= 10) ?? 45;
}

function azimuthName(deg: number): string {
  return deg % 45 === 0 ? compassPoint(deg) : `${String(deg).padStart(3, "0")}°`;
}

// Returns a line along the horizon with a tick every few degrees, for a camera on the ground. The
// names of the ticks are below the line, unless they would overlap the valid time there.
function horizon(picture: Annotated): Shape[] {
  const { projection, pose, trueNorthDeg, widthPx, heightPx, inset, letterPx } = picture;
  if (pose?.kind !== "spotter") return [];
  const viewDeg = (2 * Math.atan(Math.hypot(...projection.right)) * 180) / Math.PI;
  const step = tickStepDeg(viewDeg);
  const middle = Math.round(trueAzimuthDeg(pose.azimuthDeg, trueNorthDeg) / step) * step;
  const lowest = heightPx - inset.bottom - 3 * letterPx;
  const ticks: { readonly x: number; readonly y: number; readonly name: string }[] = [];
  for (let away = -Math.ceil(viewDeg / step); away <= Math.ceil(viewDeg / step); away += 1) {
    const deg = middle + away * step;
    const place = project(projection, add(projection.eyeM, far(deg + trueNorthDeg)));
    if (place === undefined) continue;
    const [x, natural] = at(picture, place);
    if (x < 0 || x > widthPx) continue;
    // If the horizon is above or below the picture, the line stays at the picture's edge.
    const y = Math.min(lowest, Math.max(inset.top + letterPx, natural));
    ticks.push({ x, y, name: azimuthName(wrapDegrees(deg)) });
  }
  const lowestY = Math.max(...ticks.map(({ y }) => y));
  const namesAreBelow = lowestY + 1.6 * letterPx < timeLineY(picture) - 1.3 * letterPx;
  const awayPx = (namesAreBelow ? 1.6 : -0.8) * letterPx;
  // Half of the width of a tick's name.
  const marginPx = 1.5 * letterPx;
  return [
    { kind: "line", points: ticks.map(({ x, y }) => [x, y] as const) },
    ...ticks.flatMap(({ x, y, name }): Shape[] => [
      {
        kind: "line",
        points: [
          [x, y - 0.4 * letterPx],
          [x, y + 0.4 * letterPx],
        ],
      },
      ...(x > inset.left + marginPx && x < widthPx - inset.right - marginPx
        ? [text(x, y + awayPx, name, "middle", name.length < 3)]
        : []),
    ]),
  ];
}

function far(azimuthDeg: number): Vec3 {
  const azimuth = (azimuthDeg * Math.PI) / 180;
  return [FAR_M * Math.sin(azimuth), FAR_M * Math.cos(azimuth), 0];
}

function add(a: Vec3, b: Vec3): Vec3 {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

// Returns circles on the ground around the target of an orbit camera, the position of a spotter, or
// the centre of a top-down picture.
function rings(picture: Annotated): Shape[] {
  const { pose, groundM } = picture;
  if (pose === undefined) return [];
  const reachM = reachOf(pose);
  const stepM = roundLength(reachM / MAX_RINGS);
  const middle = middleOf(pose);
  const shapes: Shape[] = [];
  for (let ring = 1; ring <= MAX_RINGS; ring += 1)
    shapes.push(...ringAround(picture, middle, ring * stepM, groundM));
  return shapes;
}

function reachOf(pose: Pose): number {
  if (pose.kind === "orbit")
    return pose.distanceM * Math.tan((pose.fieldOfViewDeg * Math.PI) / 360) * 1.6;
  return pose.kind === "topDown" ? pose.widthM / 2 : 50_000;
}

function middleOf(pose: Pose): readonly [number, number] {
  if (pose.kind === "orbit") return [pose.targetM[0], pose.targetM[1]];
  return pose.kind === "spotter" ? pose.placeM : pose.centerM;
}

function ringAround(
  picture: Annotated,
  [x, y]: readonly [number, number],
  radiusM: number,
  groundM: number,
): Shape[] {
  const corners = Array.from({ length: RING_CORNERS + 1 }, (_, corner): Vec3 => {
    const angle = (2 * Math.PI * corner) / RING_CORNERS;
    return [x + radiusM * Math.sin(angle), y + radiusM * Math.cos(angle), groundM];
  });
  const lines = projectLine(picture.projection, corners).map(
    (part): Shape => ({ kind: "line", points: part.map((point) => at(picture, point)) }),
  );
  // The distance is written where the ring is farthest to the right in the picture.
  const visible = lines
    .flatMap((line) => (line.kind === "line" ? line.points : []))
    .filter(([px, py]) => px > 0 && px < picture.widthPx && py > 0 && py < picture.heightPx);
  if (visible.length === 0) return lines;
  const [px, py] = visible.reduce((most, point) => (point[0] > most[0] ? point : most));
  return [...lines, text(px, py - 4, formatLength(radiusM, "distance"), "end")];
}
