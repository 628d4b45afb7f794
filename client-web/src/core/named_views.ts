// A list of cameras with names for each storm domain, kept in the browser's storage.
import { fromJson, toJson } from "@bufbuild/protobuf";
import { signal } from "@preact/signals-core";
import { type Camera, CameraSchema } from "../gen/thunderhead/v1/scene_pb";
import type { StormTime } from "../gen/thunderhead/v1/storm_pb";
import { KeptText, type TextStore } from "./kept_text";
import { timeLike } from "./nearest_time";

export interface NamedView {
  readonly name: string;
  readonly camera: Camera;
  // Valid time at which the view was kept. It identifies the time, because the indices of a storm's
  // times may change.
  readonly validTime: string;
  readonly timeIndex: number;
  // A small picture of the view as a data URL; may be empty.
  readonly picture: string;
}

export const VIEWS_ITEM = "thunderhead.views";
export const MAX_VIEWS = 24;

export class NamedViews {
  readonly #kept: KeptText;
  readonly #domain: () => string;
  readonly all = signal<readonly NamedView[]>([]);

  // `domain` returns the domain that is shown. It returns an empty text while the domain is
  // unknown; the list then has no views.
  constructor(storage: TextStore | undefined, domain: () => string) {
    this.#kept = new KeptText(storage, VIEWS_ITEM);
    this.#domain = domain;
  }

  // Loads the views from the browser's storage. Call this when another domain is shown, or when
  // another tab has kept or removed a view.
  load(): void {
    const domain = this.#domain();
    const stored = domain === "" ? [] : this.#read()[domain];
    this.all.value = (Array.isArray(stored) ? stored.flatMap(viewOf) : []).reduce(withView, []);
  }

  // Keeps a view. A number is appended to a name that is already used. Only the last MAX_VIEWS
  // views are kept. Returns false if the view could not be stored, so that it is lost with the
  // page.
  keep(view: NamedView): boolean {
    return this.#write(withView(this.all.peek(), view).slice(-MAX_VIEWS));
  }

  forget(name: string): void {
    this.#write(this.all.peek().filter((view) => view.name !== name));
  }

  // Returns the views. Each view's time index refers to `times`.
  at(times: readonly StormTime[]): readonly NamedView[] {
    return this.all.value.map((view) => ({
      ...view,
      timeIndex: timeLike(view.validTime, view.timeIndex, times),
    }));
  }

  // Returns an unused name like "View 3".
  freeName(): string {
    const taken = new Set(this.all.peek().map(({ name }) => name));
    let number = 1;
    while (taken.has(`View ${number}`)) number += 1;
    return `View ${number}`;
  }

  #write(views: readonly NamedView[]): boolean {
    this.all.value = views;
    const stored = views.map((view) => ({ ...view, camera: toJson(CameraSchema, view.camera) }));
    return this.#kept.write(JSON.stringify({ ...this.#read(), [this.#domain()]: stored }));
  }

  #read(): Record<string, unknown> {
    try {
      const parsed = JSON.parse(this.#kept.read() ?? "{}");
      return typeof parsed === "object" && parsed !== null ? parsed : {};
    } catch {
      return {};
    }
  }
}

function withView(views: readonly NamedView[], view: NamedView): readonly NamedView[] {
  const taken = new Set(views.map(({ name }) => name));
  let { name } = view;
  for (let number = 2; taken.has(name); number += 1) name = `${view.name} ${number}`;
  return [...views, { ...view, name }];
}

// Returns no view if another version of the page wrote an incompatible entry.
function viewOf(stored: unknown): NamedView[] {
  const { name, camera, validTime, timeIndex, picture } = (stored ?? {}) as Record<string, never>;
  try {
    return [
      {
        name: String(name),
        camera: fromJson(CameraSchema, camera ?? null),
        validTime: typeof validTime === "string" ? validTime : "",
        timeIndex: Number(timeIndex) || 0,
        picture: typeof picture === "string" ? picture : "",
      },
    ];
  } catch {
    return [];
  }
}
