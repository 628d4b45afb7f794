// Keeps a person's preferences in the browser's storage: the units of length, and the annotations
// over the picture.
import type { Signal } from "@preact/signals-core";
import { type AnnotationChoice, FIRST_ANNOTATIONS } from "./annotations";
import type { TextStore } from "./kept_text";
import type { LengthUnits } from "./units";

const ITEM = "thunderhead.preferences";

export interface Preferred {
  readonly units: Signal<LengthUnits>;
  readonly annotations: Signal<AnnotationChoice>;
}

// Sets the signals to the stored choices.
export function loadPreferences(store: TextStore | undefined, { units, annotations }: Preferred) {
  const stored = read(store);
  if (stored.units === "metric" || stored.units === "aviation") units.value = stored.units;
  const chosen = (stored.annotations ?? {}) as Record<string, unknown>;
  const known = Object.keys(FIRST_ANNOTATIONS).filter((name) => typeof chosen[name] === "boolean");
  annotations.value = {
    ...annotations.peek(),
    ...Object.fromEntries(known.map((name) => [name, chosen[name]])),
  };
}

// Stores the signals' values. Call this function in an effect, so that it runs again when a signal
// changes.
export function keepPreferences(
  store: TextStore | undefined,
  { units, annotations }: Preferred,
): void {
  const text = JSON.stringify({ units: units.value, annotations: annotations.value });
  try {
    store?.setItem(ITEM, text);
  } catch {
    // Writing fails if the storage is full or denied. The choices then last only as long as the
    // page.
  }
}

function read(store: TextStore | undefined): Record<string, unknown> {
  try {
    const parsed: unknown = JSON.parse(store?.getItem(ITEM) ?? "{}");
    return typeof parsed === "object" && parsed !== null ? (parsed as Record<string, unknown>) : {};
  } catch {
    return {};
  }
}
