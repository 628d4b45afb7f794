// Cameras with names, kept for each domain in the browser's storage.
import { fromJson, toJson } from "@bufbuild/protobuf";
import { signal } from "@preact/signals-core";
import { type Camera, CameraSchema } from "../gen/thunderhead/v1/scene_pb";
import type { StormTime } from "../gen/thunderhead/v1/storm_pb";
import { timeLike } from "./nearest_time";
import type { TextStore } from "./own_keys";

export interface NamedView {
  readonly name: string;
  readonly camera: Camera;
  // Of the time that it was kept at: what a storm's times are counted from may change.
  readonly validTime: string;
  readonly timeIndex: number;
  // A small picture as a data URL; may be empty.
  readonly picture: string;
}

export const VIEWS_ITEM = "thunderhead.views";
export const MAX_VIEWS = 24;

export class NamedViews {
  readonly #storage: TextStore | undefined;
  readonly #domain: () => string;
  readonly all = signal<readonly NamedView[]>([]);

  // `domain` tells which one is shown; empty while that is not known, when there are no views.
  constructor(storage: TextStore | undefined, domain: () => string) {
    this.#storage = storage;
    this.#domain = domain;
  }

  // Another domain is shown, or another tab has kept or forgotten a view.
  load(): void {
    const domain = this.#domain();
    const stored = domain === "" ? [] : this.#read()[domain];
    this.all.value = (Array.isArray(stored) ? stored.flatMap(viewOf) : []).reduce(withView, []);
  }

  // A name that is taken gets a number; MAX_VIEWS are kept. False if the view will not outlast the page, for want of storage.
  keep(view: NamedView): boolean {
    return this.#write(withView(this.all.peek(), view).slice(-MAX_VIEWS));
  }

  forget(name: string): void {
    this.#write(this.all.peek().filter((view) => view.name !== name));
  }

  // With their times as numbers of these.
  at(times: readonly StormTime[]): readonly NamedView[] {
    return this.all.value.map((view) => ({
      ...view,
      timeIndex: timeLike(view.validTime, view.timeIndex, times),
    }));
  }

  // "View 3".
  freeName(): string {
    const taken = new Set(this.all.peek().map(({ name }) => name));
    let number = 1;
    while (taken.has(`View ${number}`)) number += 1;
    return `View ${number}`;
  }

  #write(views: readonly NamedView[]): boolean {
    this.all.value = views;
    const stored = views.map((view) => ({ ...view, camera: toJson(CameraSchema, view.camera) }));
    try {
      const all = { ...this.#read(), [this.#domain()]: stored };
      this.#storage?.setItem(VIEWS_ITEM, JSON.stringify(all));
      return this.#storage !== undefined;
    } catch {
      // Full.
      return false;
    }
  }

  #read(): Record<string, unknown> {
    try {
      const parsed = JSON.parse(this.#storage?.getItem(VIEWS_ITEM) ?? "{}");
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

// Nothing for what another version of the page wrote.
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
