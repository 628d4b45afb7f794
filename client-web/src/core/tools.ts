// The seven tools of the tool rail, with their texts and keys.

export const TOOL_NAMES = ["map", "time", "light", "look", "fields", "probe", "marks"] as const;
export type ToolName = (typeof TOOL_NAMES)[number];

export interface ToolText {
  // Text on the rail.
  readonly label: string;
  // Text over the tool's controls.
  readonly title: string;
  // Key that opens and closes the tool.
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

// Returns the tool that a key opens. The key is the tool's letter or its number on the rail.
export function toolOfKey(key: string): ToolName | undefined {
  const place = Number(key);
  if (Number.isInteger(place) && place > 0) return TOOL_NAMES[place - 1];
  return TOOL_NAMES.find((name) => TOOL_TEXTS[name].key === key.toUpperCase());
}
