// A person's preferences, kept in the browser's storage: units, and the texts over the picture.
import type { Signal } from "@preact/signals-core";
import { type AnnotationChoice, FIRST_ANNOTATIONS } from "./annotations";
import type { TextStore } from "./own_keys";
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

// Stores the signals' values. It reads the signals, so an effect must call it.
export function keepPreferences(
  store: TextStore | undefined,
  { units, annotations }: Preferred,
): void {
  const text = JSON.stringify({ units: units.value, annotations: annotations.value });
  try {
    store?.setItem(ITEM, text);
  } catch {
    // The storage is full or denied, so the choices last as long as the page.
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
