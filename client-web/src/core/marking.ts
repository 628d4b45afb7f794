// The tools that show something to everybody: a pointer and a pen. They turn places in the picture into rays.
import { signal } from "@preact/signals-core";
import { type Later, Newest } from "./newest";
import { type Box, picturePointAt } from "./picture_box";
import { type Projection, pointOnRay, rayAt, type WorldRay } from "./projection";
import type { SessionState } from "./session_state";
import { type StrokePoint, simplifiedStroke, strokeLengthPx } from "./stroke";

// A tool in the hand: places are in CSS pixels of the window.
export interface PictureTool {
  hover(place: StrokePoint): void;
  press(place: StrokePoint): void;
  drag(place: StrokePoint): void;
  release(): void;
  // The gesture became another one.
  cancel(): void;
  leave(): void;
}

// The picture on the screen, and how far its middle is from the eye.
export interface MarkedPicture {
  readonly box: Box;
  readonly projection: Projection;
  readonly distanceM: number;
}

export interface MarkingSteps {
  picture(): MarkedPicture | undefined;
  // Without a ray the pointer goes.
  point(ray: WorldRay | undefined): void;
  // Returns the message's id; undefined if it could not be sent.
  addMark(rays: readonly WorldRay[]): bigint | undefined;
  later: Later;
}

const POINT_EVERY_MS = 34;
const MOST_CORNERS = 64;
// Shorter strokes are clicks.
const SHORTEST_STROKE_PX = 4;

export class Marking {
  // The line that is being drawn, in CSS pixels of the window.
  readonly stroke = signal<readonly StrokePoint[]>([]);
  readonly #session: SessionState;
  readonly #steps: MarkingSteps;
  readonly #points: Newest<WorldRay | undefined>;
  #pointing = false;
  readonly #pointer: PictureTool;
  readonly #pen: PictureTool;

  constructor(session: SessionState, steps: MarkingSteps) {
    this.#session = session;
    this.#steps = steps;
    this.#points = new Newest(POINT_EVERY_MS, steps.later, (ray) => steps.point(ray));
    const pointAt = (place: StrokePoint) => this.#pointAt(place);
    const withdraw = () => this.withdrawPointer();
    const nothing = () => undefined;
    this.#pointer = {
      hover: pointAt,
      press: pointAt,
      drag: pointAt,
      release: nothing,
      cancel: withdraw,
      leave: withdraw,
    };
    this.#pen = {
      hover: nothing,
      press: (place) => this.#draw([place]),
      drag: (place) => this.#draw([...this.stroke.peek(), place]),
      release: () => this.#finishStroke(),
      cancel: () => this.#draw([]),
      leave: nothing,
    };
  }

  // The tool in the hand; undefined for the camera.
  tool(): PictureTool | undefined {
    if (!this.#session.mayMark.peek()) return undefined;
    const tool = this.#session.tool.peek();
    if (tool === "pointer") return this.#pointer;
    return tool === "pen" ? this.#pen : undefined;
  }

  withdrawPointer(): void {
    if (!this.#pointing) return;
    this.#pointing = false;
    this.#points.offer(undefined);
  }

  dispose(): void {
    this.#points.dispose();
  }

  #pointAt(place: StrokePoint): void {
    const ray = this.#rayAt(place);
    if (ray === undefined) {
      this.withdrawPointer();
      return;
    }
    this.#pointing = true;
    this.#points.offer(ray);
  }

  #draw(places: readonly StrokePoint[]): void {
    this.stroke.value = places;
  }

  #finishStroke(): void {
    const places = this.stroke.peek();
    this.#draw([]);
    if (strokeLengthPx(places) < SHORTEST_STROKE_PX) return;
    const rays = simplifiedStroke(places, MOST_CORNERS).flatMap((place) => {
      const ray = this.#rayAt(place);
      return ray === undefined ? [] : [ray];
    });
    if (rays.length < 2) return;
    const requestId = this.#steps.addMark(rays);
    const distanceM = this.#steps.picture()?.distanceM ?? 0;
    if (requestId === undefined) return;
    const pending = { requestId, pointsM: rays.map((ray) => pointOnRay(ray, distanceM)) };
    this.#session.pendingMarks.value = [...this.#session.pendingMarks.peek(), pending];
  }

  #rayAt(place: StrokePoint): WorldRay | undefined {
    const picture = this.#steps.picture();
    if (picture === undefined) return undefined;
    const point = picturePointAt(picture.box, place.left, place.top);
    return point === undefined ? undefined : rayAt(picture.projection, point);
  }
}
