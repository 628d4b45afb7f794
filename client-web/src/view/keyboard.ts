// The page's keys. attachKeyboard() returns a function that removes the listener.
import { type Pose, pan, turn, zoom } from "../core/camera";
import type { Tool } from "../core/session_state";

export interface KeyActions {
  move(motion: (pose: Pose) => Pose): void;
  home(): void;
  togglePanel(): void;
  togglePlay(): void;
  stepTime(by: number): void;
  // Takes the tool into the hand, or puts it down.
  toggleTool(tool: Exclude<Tool, "camera">): void;
  // Closes what is open, puts the tool down. False if there was nothing to do.
  escape(): boolean;
}

export const KEYS: readonly (readonly [string, string])[] = [
  ["Drag, arrows", "turn"],
  ["Right or shift drag, shift + arrows", "move"],
  ["Wheel, pinch, + −", "nearer, farther"],
  ["Home", "see the whole storm"],
  ["Space", "play or pause"],
  [", .", "one time back, forward"],
  ["P", "show or hide this panel"],
  ["L", "laser pointer that everybody sees"],
  ["D", "draw lines that everybody sees"],
  ["Escape", "back to the camera"],
];

const TURN_DEG = 3;
// Moves by this many hundredths of the picture.
const PAN_PX = 5;
const PICTURE = { widthPx: 100, heightPx: 100 };
const ZOOM_FACTOR = 0.88;

const ARROWS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

export function attachKeyboard(window: Window, actions: KeyActions): () => void {
  const listening = new AbortController();
  window.addEventListener(
    "keydown",
    (event) => {
      if (event.key === "Escape" && !event.defaultPrevented && actions.escape()) {
        event.preventDefault();
      }
      if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
      if (!usesKey(event.target, event.key) && act(event, actions)) event.preventDefault();
    },
    { signal: listening.signal },
  );
  return () => listening.abort();
}

// An arrow key turns an orbit camera around the storm or a spotter's head, and moves a map.
function look(pose: Pose, right: number, down: number): Pose {
  if (pose.kind === "topDown") return pan(pose, -right * PAN_PX, -down * PAN_PX, PICTURE);
  return turn(pose, right * TURN_DEG, -down * TURN_DEG);
}

function act(event: KeyboardEvent, actions: KeyActions): boolean {
  const arrow = ARROWS[event.key];
  if (arrow !== undefined) {
    const [right, down] = arrow;
    if (event.shiftKey) actions.move((pose) => pan(pose, right * PAN_PX, down * PAN_PX, PICTURE));
    else actions.move((pose) => look(pose, right, down));
    return true;
  }
  switch (event.key) {
    case "+":
    case "=":
      actions.move((pose) => zoom(pose, ZOOM_FACTOR));
      return true;
    case "-":
    case "_":
      actions.move((pose) => zoom(pose, 1 / ZOOM_FACTOR));
      return true;
    case "Home":
      actions.home();
      return true;
    case "p":
    case "P":
      actions.togglePanel();
      return true;
    case "l":
    case "L":
      actions.toggleTool("pointer");
      return true;
    case "d":
    case "D":
      actions.toggleTool("pen");
      return true;
    case " ":
      actions.togglePlay();
      return true;
    case ",":
      actions.stepTime(-1);
      return true;
    case ".":
      actions.stepTime(1);
      return true;
    default:
      return false;
  }
}

// True if the focused control uses the key itself: a text uses all keys, a slider or a radio button the arrows, a
// button the space bar.
function usesKey(target: EventTarget | null, key: string): boolean {
  if (!(target instanceof Element)) return false;
  const control = target.closest("input, select, textarea, button, summary, [role=slider]");
  if (control === null) return false;
  if (control.matches("button, summary, input[type=checkbox]")) return key === " ";
  if (control.matches("input[type=range], [role=slider]")) {
    return key in ARROWS || key === "Home" || key === "End";
  }
  if (control.matches("input[type=radio]")) return key in ARROWS || key === " ";
  return true;
}
