// Converts mouse and touch over the storm to camera motions. A drag turns the camera. A drag with
// the right button, Shift or two fingers moves it. The wheel or a pinch zooms. If a tool is active,
// the left button or one finger uses the tool. attachPointer() returns a function that removes the
// listeners.
import { drag, type PictureSize, type Pose, pan, zoom } from "../core/camera";
import type { PictureTool } from "../core/marking";
import type { StrokePoint } from "../core/stroke";

export interface PointerSteps {
  move(motion: (pose: Pose) => Pose): void;
  // Returns the active tool; undefined if the pointer moves the camera.
  tool(): PictureTool | undefined;
  // clicked() and doubleClicked() report presses and releases at one place while no tool is active.
  clicked(place: StrokePoint): void;
  doubleClicked(place: StrokePoint): void;
}

// If the pointer moves farther than this between press and release, the gesture is a drag instead
// of a click.
const CLICK_PX = 4;

interface Point {
  readonly x: number;
  readonly y: number;
}

// One notch of a common wheel, 100 pixels, changes the distance by 14 %.
const WHEEL_PER_PIXEL = 0.0013;
// Browsers report a pinch on a touchpad as a wheel with small steps and the control key.
const TOUCHPAD_PINCH_PER_PIXEL = 0.01;
const LINE_PX = 16;
const SECONDARY_AND_MIDDLE_BUTTONS = 2 | 4;

export function attachPointer(canvas: HTMLCanvasElement, steps: PointerSteps): () => void {
  const move = (motion: (pose: Pose) => Pose) => steps.move(motion);
  const toolInHand = () => steps.tool();
  const down = new Map<number, Point>();
  const listening = new AbortController();
  const options = { signal: listening.signal };
  // `drawing` is the pointer (mouse or finger) that uses the tool. `down` also contains this
  // pointer.
  let pressedAt: StrokePoint | undefined;
  let drawing: { readonly pointerId: number; readonly tool: PictureTool } | undefined;

  canvas.addEventListener(
    "pointerdown",
    (event) => {
      canvas.setPointerCapture(event.pointerId);
      const tool = toolInHand();
      if (down.size > 0) {
        drawing?.tool.cancel();
        drawing = undefined;
      } else if (tool !== undefined && event.button === 0 && !event.shiftKey) {
        drawing = { pointerId: event.pointerId, tool };
        tool.press(placeOf(event));
      }
      down.set(event.pointerId, pointOf(event));
      const mayClick = down.size === 1 && drawing === undefined && event.button === 0;
      pressedAt = mayClick && !event.shiftKey ? placeOf(event) : undefined;
      if (drawing === undefined) canvas.classList.add("grabbed");
    },
    options,
  );

  canvas.addEventListener(
    "pointermove",
    (event) => {
      const before = down.get(event.pointerId);
      if (before === undefined) {
        toolInHand()?.hover(placeOf(event));
        return;
      }
      if (drawing?.pointerId === event.pointerId) {
        for (const part of event.getCoalescedEvents()) drawing.tool.drag(placeOf(part));
        drawing.tool.drag(placeOf(event));
        return;
      }
      const after = pointOf(event);
      const picture = { widthPx: canvas.clientWidth, heightPx: canvas.clientHeight };
      if (down.size === 1) {
        const [rightPx, downPx] = [after.x - before.x, after.y - before.y];
        const panning = event.shiftKey || (event.buttons & SECONDARY_AND_MIDDLE_BUTTONS) !== 0;
        move((pose) => (panning ? pan : drag)(pose, rightPx, downPx, picture));
      } else if (down.size === 2) {
        const other = [...down].find(([id]) => id !== event.pointerId)?.[1];
        if (other !== undefined) move((pose) => pinch(pose, before, after, other, picture));
      }
      down.set(event.pointerId, after);
    },
    options,
  );

  const release = (event: PointerEvent) => {
    down.delete(event.pointerId);
    if (drawing?.pointerId === event.pointerId) {
      if (event.type === "pointerup") drawing.tool.release();
      else drawing.tool.cancel();
      drawing = undefined;
    }
    if (event.type === "pointerup" && pressedAt !== undefined && isNear(pressedAt, placeOf(event)))
      steps.clicked(placeOf(event));
    pressedAt = undefined;
    if (down.size === 0) canvas.classList.remove("grabbed");
  };
  canvas.addEventListener("pointerup", release, options);
  canvas.addEventListener("pointercancel", release, options);
  canvas.addEventListener("pointerleave", () => toolInHand()?.leave(), options);
  canvas.addEventListener(
    "dblclick",
    (event) => {
      if (toolInHand() === undefined) steps.doubleClicked(placeOf(event));
    },
    options,
  );
  canvas.addEventListener("contextmenu", (event) => event.preventDefault(), options);

  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE_PX : 1);
      const rate = event.ctrlKey ? TOUCHPAD_PINCH_PER_PIXEL : WHEEL_PER_PIXEL;
      move((pose) => zoom(pose, Math.exp(pixels * rate)));
    },
    { ...options, passive: false },
  );

  return () => listening.abort();
}

// Handles a motion of one of two fingers. Their midpoint pans, and their distance zooms.
function pinch(pose: Pose, before: Point, after: Point, other: Point, picture: PictureSize): Pose {
  const apartBefore = Math.hypot(before.x - other.x, before.y - other.y);
  const apartAfter = Math.hypot(after.x - other.x, after.y - other.y);
  const nearer = zoom(pose, Math.max(1, apartBefore) / Math.max(1, apartAfter));
  return pan(nearer, (after.x - before.x) / 2, (after.y - before.y) / 2, picture);
}

function pointOf(event: PointerEvent): Point {
  return { x: event.clientX, y: event.clientY };
}

function isNear(a: StrokePoint, b: StrokePoint): boolean {
  return Math.hypot(a.left - b.left, a.top - b.top) <= CLICK_PX;
}

// Returns the event's place in the window, in CSS pixels.
function placeOf(event: MouseEvent): StrokePoint {
  return { left: event.clientX, top: event.clientY };
}
