// Cameras with names, kept for each storm in the browser's storage.
import { fromJson, toJson } from "@bufbuild/protobuf";
import { signal } from "@preact/signals-core";
import { type Camera, CameraSchema } from "../gen/thunderhead/v1/scene_pb";
import type { TextStore } from "./own_keys";

export interface NamedView {
  readonly name: string;
  readonly camera: Camera;
  // Of the storm's times.
  readonly timeIndex: number;
  // A small picture as a data URL; may be empty.
  readonly picture: string;
}

const KEY = "thunderhead.views";
const MAX_VIEWS = 24;

export class NamedViews {
  readonly #storage: TextStore | undefined;
  readonly #stormId: () => string;
  readonly all = signal<readonly NamedView[]>([]);

  constructor(storage: TextStore | undefined, stormId: () => string) {
    this.#storage = storage;
    this.#stormId = stormId;
  }

  // Another storm is shown.
  load(): void {
    const stored = this.#read()[this.#stormId()];
    this.all.value = (Array.isArray(stored) ? stored.flatMap(viewOf) : []).reduce(withView, []);
  }

  // A name that is taken gets a number.
  keep(view: NamedView): void {
    this.#write(withView(this.all.peek(), view).slice(-MAX_VIEWS));
  }

  forget(name: string): void {
    this.#write(this.all.peek().filter((view) => view.name !== name));
  }

  // "View 3".
  freeName(): string {
    const taken = new Set(this.all.peek().map(({ name }) => name));
    let number = 1;
    while (taken.has(`View ${number}`)) number += 1;
    return `View ${number}`;
  }

  #write(views: readonly NamedView[]): void {
    this.all.value = views;
    const stored = views.map((view) => ({ ...view, camera: toJson(CameraSchema, view.camera) }));
    try {
      this.#storage?.setItem(KEY, JSON.stringify({ ...this.#read(), [this.#stormId()]: stored }));
    } catch {
      // Full: they last as long as the page.
    }
  }

  #read(): Record<string, unknown> {
    try {
      const parsed = JSON.parse(this.#storage?.getItem(KEY) ?? "{}");
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
  const { name, camera, timeIndex, picture } = (stored ?? {}) as Record<string, never>;
  try {
    return [
      {
        name: String(name),
        camera: fromJson(CameraSchema, camera ?? null),
        timeIndex: Number(timeIndex) || 0,
        picture: typeof picture === "string" ? picture : "",
      },
    ];
  } catch {
    return [];
  }
}
