// The seven tools of the rail, each for one question that people ask of a storm.

export const TOOL_NAMES = ["map", "time", "light", "look", "fields", "probe", "marks"] as const;
export type ToolName = (typeof TOOL_NAMES)[number];

export interface ToolText {
  // On the rail.
  readonly label: string;
  // Over its controls.
  readonly title: string;
  // Opens and closes it.
  readonly key: string;
}

export const TOOL_TEXTS: Readonly<Record<ToolName, ToolText>> = {
  map: { label: "Map", title: "Map and camera", key: "M" },
  time: { label: "Time", title: "Time", key: "T" },
  light: { label: "Light", title: "Light", key: "L" },
  look: { label: "Look", title: "Look", key: "K" },
  fields: { label: "Fields", title: "Fields", key: "F" },
  probe: { label: "Probe", title: "Probe", key: "P" },
  marks: { label: "Marks", title: "Marks", key: "D" },
};

// Panels that a button of the top bar opens.
export type PanelName = "storms" | "share" | "people" | "keep" | "compare" | "help";

// The tool that a key opens: its letter, or its place on the rail.
export function toolOfKey(key: string): ToolName | undefined {
  const place = Number(key);
  if (Number.isInteger(place) && place > 0) return TOOL_NAMES[place - 1];
  return TOOL_NAMES.find((name) => TOOL_TEXTS[name].key === key.toUpperCase());
}
