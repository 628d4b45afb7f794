// The page's keys. attachKeyboard() returns a function that removes the listener.
import { type Pose, pan, turn, zoom } from "../core/camera";
import { type PanelName, TOOL_NAMES, TOOL_TEXTS, type ToolName, toolOfKey } from "../core/tools";

export interface KeyActions {
  move(motion: (pose: Pose) => Pose): void;
  home(): void;
  toggleTool(name: ToolName): void;
  toggleDrawer(): void;
  togglePanel(name: PanelName): void;
  togglePlay(): void;
  stepTime(by: number): void;
  undo(): void;
  redo(): void;
  // Handles the Enter key. Returns false if the key has no meaning now.
  enter(): boolean;
  fullScreen(): void;
  // Closes the uppermost panel or tool, or puts the pen down. Returns false if there was nothing to
  // do.
  escape(): boolean;
}

export const KEYS: readonly (readonly [string, string])[] = [
  ["Drag, arrows", "turn"],
  ["Right or shift drag, shift + arrows", "move"],
  ["Wheel, pinch, + −", "nearer, farther"],
  ["Home", "see the whole storm"],
  ["Space", "play or pause"],
  [", .", "one time back, forward"],
  ...TOOL_NAMES.map((name, at): readonly [string, string] => [
    `${TOOL_TEXTS[name].key} or ${at + 1}`,
    TOOL_TEXTS[name].title,
  ]),
  ["Enter, with the probe open", "probe the middle of the picture"],
  ["X", "every setting"],
  ["S", "save: picture, movie, link"],
  ["C", "compare"],
  ["H", "share"],
  ["Ctrl + Z, Ctrl + Y", "undo, redo"],
  ["W", "full screen"],
  ["?", "these keys"],
  ["Escape", "close what is open"],
];

const PANEL_KEYS: Readonly<Record<string, PanelName>> = {
  s: "keep",
  c: "compare",
  h: "share",
  "?": "help",
};

const TURN_DEG = 3;
// Pan distance of one key press in pixels of PICTURE, which is 100 x 100 pixels: 5 % of the
// picture.
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
      if (!event.defaultPrevented && undoes(event, actions)) event.preventDefault();
      if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
      if (!usesKey(event.target, event.key) && act(event, actions)) event.preventDefault();
    },
    { signal: listening.signal },
  );
  return () => listening.abort();
}

// Turns an orbit camera around the storm or a spotter's head by an arrow key, or moves a map.
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
    case "Enter":
      return actions.enter();
    case "x":
    case "X":
      actions.toggleDrawer();
      return true;
    case "w":
    case "W":
      actions.fullScreen();
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
      return opens(event.key, actions);
  }
}

function opens(key: string, actions: KeyActions): boolean {
  const tool = toolOfKey(key);
  const panel = PANEL_KEYS[key.toLowerCase()];
  if (tool !== undefined) actions.toggleTool(tool);
  else if (panel !== undefined) actions.togglePanel(panel);
  return tool !== undefined || panel !== undefined;
}

// Handles the keys of undo and redo. A text field undoes its own changes instead.
function undoes(event: KeyboardEvent, actions: KeyActions): boolean {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return false;
  const target = event.target instanceof Element ? event.target : undefined;
  if (target?.closest("input:not([type=range], [type=checkbox], [type=radio]), textarea"))
    return false;
  const key = event.key.toLowerCase();
  if (key === "z" && !event.shiftKey) actions.undo();
  else if (key === "y" || key === "z") actions.redo();
  else return false;
  return true;
}

// Returns true if the focused control uses the key itself. A text field or a list uses all keys. A
// slider uses the arrows, Home and End, and a radio button the arrows and the space bar. A button
// or a checkbox uses the space bar and Enter.
function usesKey(target: EventTarget | null, key: string): boolean {
  if (!(target instanceof Element)) return false;
  const control = target.closest("input, select, textarea, button, summary, [role=slider]");
  if (control === null) return false;
  if (control.matches("button, summary, input[type=checkbox]"))
    return key === " " || key === "Enter";
  if (control.matches("input[type=range], [role=slider]")) {
    return key in ARROWS || key === "Home" || key === "End";
  }
  if (control.matches("input[type=radio]")) return key in ARROWS || key === " ";
  return true;
}
