// The page's icons, 24 x 24, drawn with lines in the colour of the text.
import type { ToolName } from "../core/tools";

const PATHS = {
  map: "M9 4 3 6.5v13L9 17l6 3 6-2.5v-13L15 7zM9 4v13M15 7v13",
  time: "M12 3.5a8.5 8.5 0 1 0 0 17 8.5 8.5 0 0 0 0-17zM12 7.5V12l3 2",
  light:
    "M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8zM12 2.5v2.5M12 19v2.5M2.5 12H5M19 12h2.5M5.3 5.3 7 7M17 17l1.7 1.7M18.7 5.3 17 7M7 17l-1.7 1.7",
  look: "M12 3.5a8.5 8.5 0 1 0 0 17 8.5 8.5 0 0 0 0-17zM12 4v16M13 7h5M13 10h7M13 13h7M13 16h5.5",
  fields: "M12 4 3 9l9 5 9-5zM3 14l9 5 9-5",
  probe: "M12 6a6 6 0 1 0 0 12 6 6 0 0 0 0-12zM12 2.5V8M12 16v5.5M2.5 12H8M16 12h5.5",
  marks: "M16.5 4 20 7.5 8.5 19 4 20l1-4.5zM14 6.5 17.5 10",
  play: "M8 5.5v13l11-6.5z",
  pause: "M8 5.5v13M16 5.5v13",
  loop: "M19.5 12a7.5 7.5 0 1 1-2.2-5.3L19.5 9M19.5 4.5V9H15",
  back: "M15 6l-6 6 6 6",
  forward: "M9 6l6 6-6 6",
  expand: "M9 4H4v5M15 4h5v5M9 20H4v-5M15 20h5v-5",
  settings: "M4 7h9M17 7h3M15 5v4M4 12h3M11 12h9M9 10v4M4 17h9M17 17h3M15 15v4",
  help: "M9.2 9a2.9 2.9 0 1 1 4.3 2.5c-1 .6-1.5 1.2-1.5 2.5M12 17.5v.5M12 3.5a8.5 8.5 0 1 0 0 17 8.5 8.5 0 0 0 0-17z",
  compare: "M4 5h16v14H4zM12 3v18M7 12h2M15 12h2",
  people:
    "M9 5a3 3 0 1 0 0 6 3 3 0 0 0 0-6zM3 19c0-3.5 2.5-5.5 6-5.5s6 2 6 5.5M16 6a2.5 2.5 0 0 1 0 5M17 14c2.5.3 4 2 4 5",
  pen: "M16.5 4 20 7.5 8.5 19 4 20l1-4.5z",
  arrow: "M5 19 19 5M9 5h10v10",
  text: "M5 7V5h14v2M12 5v14M9 19h6",
  pointer: "M12 9a3 3 0 1 0 0 6 3 3 0 0 0 0-6zM12 3v3M12 18v3M3 12h3M18 12h3",
  undo: "M8 5 4 9l4 4M4 9h10a6 6 0 0 1 0 12h-4",
  redo: "M16 5l4 4-4 4M20 9H10a6 6 0 0 0 0 12h4",
} as const;

export type IconName = keyof typeof PATHS | ToolName;

export function Icon({ name }: { name: IconName }) {
  return (
    <svg class="icon" viewBox="0 0 24 24" aria-hidden="true">
      <path d={PATHS[name]} />
    </svg>
  );
}
