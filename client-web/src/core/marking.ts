// The tools that show something to all people in the session: a pointer, a pen, an arrow and a
// text. The tools convert points of the picture to rays from the camera.
import { signal } from "@preact/signals-core";
import { arrowStrokes, joined, letterStrokes, ringStroke, wordsWidthPx } from "./lettering";
import { type Later, Newest } from "./newest";
import { type Box, picturePointAt } from "./picture_box";
import { type Projection, pointOnRay, rayAt, type WorldRay } from "./projection";
import type { PendingMark, SessionState, Tool } from "./session_state";
import { type StrokePoint, simplifiedStroke, strokeLengthPx } from "./stroke";

// An active tool. Places are in CSS pixels of the window.
export interface PictureTool {
  hover(place: StrokePoint): void;
  press(place: StrokePoint): void;
  drag(place: StrokePoint): void;
  release(): void;
  // Cancels the stroke, because the gesture has become a different one, such as a pinch.
  cancel(): void;
  leave(): void;
}

// The picture on the screen, and the distance from the camera to what the picture's middle shows.
export interface MarkedPicture {
  readonly box: Box;
  readonly projection: Projection;
  readonly distanceM: number;
}

export interface MarkingSteps {
  picture(): MarkedPicture | undefined;
  // Sends the pointer's ray to the session; undefined removes the pointer.
  point(ray: WorldRay | undefined): void;
  // Sends a mark. Returns the message's id; undefined if it could not be sent.
  addMark(rays: readonly WorldRay[]): bigint | undefined;
  later: Later;
}

const POINT_EVERY_MS = 34;
// Maximum number of attempts to send a mark while the server is busy with the previous one.
const MAX_SENDINGS = 25;
const MAX_REMEMBERED = 64;
const MAX_CORNERS = 64;
const LETTER_PX = 22;
// Minimum distance between a text and the picture's edge.
const EDGE_PX = 4;
const RING_PX = 60;
const ARROW_PX = 70;
// A stroke shorter than this counts as a click.
const SHORTEST_STROKE_PX = 4;

// A mark that was sent.
interface SentMark {
  readonly pending: PendingMark;
  readonly rays: readonly WorldRay[];
  readonly sendings: number;
}

export class Marking {
  // The line that is being drawn, in CSS pixels of the window.
  readonly stroke = signal<readonly StrokePoint[]>([]);
  // The text that the text tool writes.
  readonly words = signal("");
  readonly #session: SessionState;
  readonly #steps: MarkingSteps;
  readonly #points: Newest<WorldRay | undefined>;
  readonly #sent = new Map<bigint, SentMark>();
  readonly #resting = new Set<() => void>();
  #lastMarkId = 0;
  #pointing = false;
  readonly #pointer: PictureTool;
  readonly #pen: PictureTool;
  readonly #arrow: PictureTool;
  readonly #text: PictureTool;

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
    this.#arrow = {
      hover: nothing,
      press: (place) => this.#draw([place]),
      drag: (place) => this.#draw([this.stroke.peek()[0] ?? place, place]),
      release: () => this.#finishArrow(),
      cancel: () => this.#draw([]),
      leave: nothing,
    };
    this.#text = {
      hover: nothing,
      press: (place) => this.#draw([place]),
      drag: (place) => this.#draw([place]),
      release: () => {
        const [place] = this.stroke.peek();
        this.#draw([]);
        if (place !== undefined) this.write(place);
      },
      cancel: () => this.#draw([]),
      leave: nothing,
    };
  }

  // Returns the active tool; undefined if the pointer moves the camera.
  tool(): PictureTool | undefined {
    if (!this.#session.mayMark.peek()) return undefined;
    const tool = this.#session.tool.peek();
    if (tool === "camera") return undefined;
    return { pointer: this.#pointer, pen: this.#pen, arrow: this.#arrow, text: this.#text }[tool];
  }

  // Writes the text to the right of a place, or centred on the place. A text that would extend
  // beyond the picture is moved into it. A text that is wider than the picture is written smaller.
  write({ left, top }: StrokePoint, from: "start" | "middle" = "start"): void {
    const words = this.words.peek().trim();
    const box = this.#steps.picture()?.box;
    if (words === "" || box === undefined) return;
    const fullWidthPx = wordsWidthPx(words, LETTER_PX);
    const scale = Math.min(1, (box.width - 2 * EDGE_PX) / Math.max(1, fullWidthPx));
    const [widthPx, heightPx] = [scale * fullWidthPx, scale * LETTER_PX];
    const within = (at: number, low: number, room: number) =>
      Math.max(low + EDGE_PX, Math.min(at, low + room - EDGE_PX));
    const place = {
      left: within(from === "middle" ? left - widthPx / 2 : left, box.left, box.width - widthPx),
      top: within(top - heightPx / 2, box.top, box.height - heightPx),
    };
    this.#addMark(joined(letterStrokes(words, place, heightPx)));
  }

  // Makes a mark without a mouse, in the middle of the picture. The tool determines the mark: a
  // ring around the middle, an arrow to the middle, the text, or the pointer.
  markMiddle(tool: Exclude<Tool, "camera">): void {
    const box = this.#steps.picture()?.box;
    if (box === undefined) return;
    const middle = { left: box.left + box.width / 2, top: box.top + box.height / 2 };
    if (tool === "text") this.write(middle, "middle");
    else if (tool === "pointer") this.#pointAt(middle);
    else if (tool === "pen") this.#addMark(ringStroke(middle, RING_PX));
    else {
      const tail = { left: middle.left - ARROW_PX, top: middle.top - ARROW_PX };
      this.#addMark(joined(arrowStrokes(tail, middle)));
    }
  }

  withdrawPointer(): void {
    if (!this.#pointing) return;
    this.#pointing = false;
    this.#points.offer(undefined);
  }

  // Handles a mark that the server refused. Returns true if the mark will be sent again after the
  // delay.
  refused(requestId: bigint, afterMs: number | undefined): boolean {
    const mark = this.#sent.get(requestId);
    if (mark === undefined) return false;
    this.#sent.delete(requestId);
    const { pendingMarks } = this.#session;
    const others = pendingMarks.peek().filter(({ id }) => id !== mark.pending.id);
    if (afterMs === undefined || mark.sendings >= MAX_SENDINGS) {
      pendingMarks.value = others;
      return false;
    }
    const waiting = { ...mark.pending, requestId: undefined };
    pendingMarks.value = [...others, waiting];
    const withdraw = this.#steps.later(afterMs, () => {
      this.#resting.delete(withdraw);
      // When the page joins again it drops its pending marks, so this mark must then not be sent
      // again.
      if (pendingMarks.peek().includes(waiting)) this.#send({ ...mark, pending: waiting });
    });
    this.#resting.add(withdraw);
    return true;
  }

  dispose(): void {
    this.#points.dispose();
    for (const withdraw of this.#resting) withdraw();
    this.#resting.clear();
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
    this.#addMark(simplifiedStroke(places, MAX_CORNERS));
  }

  #finishArrow(): void {
    const places = this.stroke.peek();
    this.#draw([]);
    const [tail, tip] = places;
    if (tail === undefined || tip === undefined) return;
    if (strokeLengthPx(places) >= SHORTEST_STROKE_PX)
      this.#addMark(joined(arrowStrokes(tail, tip)));
  }

  #addMark(places: readonly StrokePoint[]): void {
    const rays = places.flatMap((place) => {
      const ray = this.#rayAt(place);
      return ray === undefined ? [] : [ray];
    });
    if (rays.length < 2) return;
    const distanceM = this.#steps.picture()?.distanceM ?? 0;
    const pointsM = rays.map((ray) => pointOnRay(ray, distanceM));
    this.#lastMarkId += 1;
    this.#send({
      pending: { id: this.#lastMarkId, requestId: undefined, pointsM },
      rays,
      sendings: 0,
    });
  }

  // Sends a mark and puts it last among the pending marks, because the server accepts marks in the
  // order of arrival.
  #send({ pending, rays, sendings }: SentMark): void {
    const { pendingMarks } = this.#session;
    const others = pendingMarks.peek().filter(({ id }) => id !== pending.id);
    const requestId = this.#steps.addMark(rays);
    if (requestId === undefined) {
      pendingMarks.value = others;
      return;
    }
    const sent = { ...pending, requestId };
    this.#sent.set(requestId, { pending: sent, rays, sendings: sendings + 1 });
    // The server sends no response to an accepted mark, so the oldest sent marks are forgotten.
    for (const oldest of this.#sent.keys()) {
      if (this.#sent.size <= MAX_REMEMBERED) break;
      this.#sent.delete(oldest);
    }
    pendingMarks.value = [...others, sent];
  }

  #rayAt(place: StrokePoint): WorldRay | undefined {
    const picture = this.#steps.picture();
    if (picture === undefined) return undefined;
    const point = picturePointAt(picture.box, place.left, place.top);
    return point === undefined ? undefined : rayAt(picture.projection, point);
  }
}
