// Saves files, one at a time: scenes, movies, and pictures that contain their scene. The progress
// is published as a signal.
import type { Transport } from "@connectrpc/connect";
import { ConnectError } from "@connectrpc/connect";
import { signal } from "@preact/signals-core";
import type { AnnotationChoice } from "../../core/annotations";
import { type PictureSize, poseOfCamera } from "../../core/camera";
import type { TextStore } from "../../core/kept_text";
import { type MovieDraft, movieScenes } from "../../core/movie_plan";
import { type MovieWork, RememberedMovies } from "../../core/movie_work";
import type { NamedView } from "../../core/named_views";
import { projectionOf } from "../../core/projection";
import { outputSize, withOutput } from "../../core/scene";
import { sceneOfFile, sceneToText, withScene } from "../../core/scene_file";
import type { PageState } from "../../core/state";
import type { Mark } from "../../gen/thunderhead/v1/interact_pb";
import type { Scene } from "../../gen/thunderhead/v1/scene_pb";
import { ImageFormat } from "../../gen/thunderhead/v1/thunderhead_pb";
import { type DrawnPicture, RenderCalls } from "../../transport/render_calls";
import { annotated, drawAnnotations, type Labels, labelsOf } from "../annotations";
import { drawMarks } from "../mark_drawing";
import type { Notes } from "../notes";
import { couldNotBeLoaded } from "../part";

// What is drawn over the pictures of a file, and the file's name, as they were when the file was
// begun.
interface Caption {
  readonly labels: Labels;
  readonly choice: AnnotationChoice;
  readonly marks: readonly Mark[];
  // The file's name without its extension.
  readonly fileName: string;
}

export interface KeeperSteps {
  // Returns the named views, with the storm's own times.
  views(): readonly NamedView[];
  pausePlayback(): void;
}

export interface Work {
  readonly what: string;
  // Progress from 0 to 1.
  readonly share: number;
}

// Returns a text like "Movie: 34 %".
export function workInWords({ what, share }: Work): string {
  return `${what}: ${Math.round(100 * share)} %`;
}

// A request in the panel that was refused, and the reason.
export interface Refusal {
  readonly asked: Asked;
  readonly why: string;
}

type Asked = "Picture" | "Movie" | "File";

function movieFile() {
  return import("./movie_file").catch(() => {
    throw new Error(couldNotBeLoaded("The part of the page that writes movies"));
  });
}

export class Keeper {
  readonly #calls: RenderCalls;
  readonly #state: PageState;
  readonly #notes: Notes;
  readonly #steps: KeeperSteps;
  readonly #remembered: RememberedMovies;
  #working: AbortController | undefined;
  // True if a reload of the page continues the file that is being made.
  #outlivesPage = false;
  // The file that is being made; undefined if no file is being made.
  readonly work = signal<Work | undefined>(undefined);
  // The last refusal, until the next request.
  readonly refusal = signal<Refusal | undefined>(undefined);

  constructor(
    transport: Transport,
    state: PageState,
    notes: Notes,
    steps: KeeperSteps,
    // The browser's storage for this tab only.
    tabStore: TextStore | undefined,
  ) {
    this.#calls = new RenderCalls(transport);
    this.#state = state;
    this.#notes = notes;
    this.#steps = steps;
    this.#remembered = new RememberedMovies(tabStore);
  }

  listen(window: Window, options: { readonly signal: AbortSignal }): void {
    // Dropping a saved picture on the page restores its scene.
    window.addEventListener("dragover", (event) => event.preventDefault(), options);
    window.addEventListener(
      "drop",
      (event) => {
        event.preventDefault();
        const file = event.dataTransfer?.files[0];
        if (file !== undefined) void this.open(file);
      },
      options,
    );
    // Leaving the page would lose a file that is being made, so the browser asks first.
    window.addEventListener(
      "beforeunload",
      (event) => {
        if (this.work.peek() !== undefined && !this.#outlivesPage) event.preventDefault();
      },
      options,
    );
  }

  cancel(): void {
    this.#working?.abort();
  }

  dispose(): void {
    this.cancel();
  }

  savePicture({ widthPx, heightPx }: PictureSize): Promise<void> {
    const caption = this.#caption();
    return this.#make("Picture", async (abort, progress) => {
      const scene = withOutput(this.sceneShown(), outputSize(widthPx, heightPx, 1));
      const picture = await this.#calls.picture(scene, ImageFormat.PNG, abort, progress);
      const canvas = await annotate(picture, caption);
      const blob = await canvas.convertToBlob({ type: "image/png" });
      const file = withScene(new Uint8Array(await blob.arrayBuffer()), scene);
      if (file !== undefined) download(file, `${caption.fileName}.png`, "image/png");
    });
  }

  saveScene(): void {
    const text = sceneToText(this.sceneShown());
    download(
      new TextEncoder().encode(text),
      `${this.#caption().fileName}.json`,
      "application/json",
    );
  }

  // Opens a saved picture or scene.
  async open(file: File): Promise<void> {
    this.#allow("file");
    try {
      const scene = sceneOfFile(new Uint8Array(await file.arrayBuffer()));
      const block = this.#state.session.editBlock.peek();
      if (block !== undefined) throw new Error(`the scene cannot be changed from here: ${block}`);
      // Playback stops so that the file's time stays on the screen.
      this.#steps.pausePlayback();
      this.#state.restore(scene);
      this.#notes.say("file", `The view of ${file.name}`);
    } catch (error) {
      this.#refuse("file", "File", `${file.name} cannot be opened: ${(error as Error).message}`);
    }
  }

  // Returns true if this browser cannot write an MP4 with H.264, which every player supports.
  async lacksH264(size: PictureSize): Promise<boolean> {
    try {
      return (await (await movieFile()).codecOf({ ...size, format: "mp4" })) !== "avc";
    } catch {
      // The error is ignored here, because it is shown when the movie is made.
      return false;
    }
  }

  saveMovie(draft: MovieDraft): Promise<void> {
    const caption = this.#caption();
    const stormId = this.#state.stormId.peek();
    return this.#make("Movie", async (abort, progress) => {
      const scenes = movieScenes(this.sceneShown(), draft, this.#steps.views());
      // The codec is checked before the server draws pictures that this browser could not encode.
      await (await movieFile()).codecOf(draft);
      const jobId = await this.#calls.beginJob(scenes, `movie of ${stormId}`, abort);
      if (jobId === undefined) {
        const pictures = this.#calls.pictures(scenes, abort);
        return this.#writeMovie(draft, caption, pictures, scenes.length, progress);
      }
      const work = { jobId, pictures: scenes.length, draft, stormId };
      this.#outlivesPage = this.#remembered.remember(work);
      await this.#writeMovieOfJob(work, caption, abort, progress);
    });
  }

  // Continues a movie that a reload interrupted, once its storm is shown.
  resumeMovie(stormId: string): void {
    const work = this.#remembered.of(stormId);
    if (work === undefined || this.#working !== undefined) return;
    const caption = this.#caption();
    void this.#make("Movie", (abort, progress) => {
      this.#outlivesPage = true;
      return this.#writeMovieOfJob(work, caption, abort, progress);
    });
  }

  async #writeMovieOfJob(
    { jobId, pictures, draft, stormId }: MovieWork,
    caption: Caption,
    abort: AbortSignal,
    progress: (share: number) => void,
  ): Promise<void> {
    try {
      const drawn = this.#calls.picturesOfJob(jobId, pictures, abort);
      await this.#writeMovie(draft, caption, drawn, pictures, progress);
    } finally {
      // The movie is finished or cancelled, or has failed, so no page fetches its pictures again.
      this.#remembered.forget(stormId);
      await this.#calls.forgetJob(jobId);
    }
  }

  async #writeMovie(
    draft: MovieDraft,
    caption: Caption,
    pictures: AsyncGenerator<DrawnPicture>,
    count: number,
    progress: (share: number) => void,
  ): Promise<void> {
    const movie = await (await movieFile()).startMovie(draft);
    try {
      let done = 0;
      for await (const picture of pictures) {
        await movie.add(await annotate(picture, caption));
        done += 1;
        progress(done / count);
      }
      const { format } = draft;
      download(await movie.finish(), `${caption.fileName}.${format}`, `video/${format}`);
    } catch (error) {
      await movie.cancel();
      throw error;
    }
  }

  async #make(
    what: "Picture" | "Movie",
    make: (abort: AbortSignal, progress: (share: number) => void) => Promise<void>,
  ): Promise<void> {
    if (this.#working !== undefined) return;
    const working = new AbortController();
    this.#working = working;
    this.work.value = { what, share: 0 };
    this.#allow("keep");
    try {
      await make(working.signal, (share) => {
        this.work.value = { what, share };
      });
    } catch (error) {
      if (working.signal.aborted) return;
      const why = error instanceof ConnectError ? error.rawMessage : (error as Error).message;
      this.#refuse("keep", what, `${what} not saved: ${why}`);
    } finally {
      this.#working = undefined;
      this.#outlivesPage = false;
      this.work.value = undefined;
    }
  }

  // Shows the reason in the panel. If the panel is closed, for example after a long movie or a
  // dropped file, shows it over the picture.
  #refuse(subject: string, asked: Asked, why: string): void {
    if (this.#state.popover.peek() === "keep") this.refusal.value = { asked, why };
    else this.#notes.problem(subject, why);
  }

  #allow(subject: string): void {
    this.refusal.value = undefined;
    this.#state.dismiss(subject);
  }

  // Returns the scene that is shown. While this page looks around, this scene has the camera of the
  // own view.
  sceneShown(): Scene {
    const scene = this.#state.scene.peek();
    const frame = this.#state.frame.peek();
    const own = frame?.ownView === true ? this.#state.shownCamera.peek() : undefined;
    return own === undefined ? scene : { ...scene, camera: own };
  }

  #caption(): Caption {
    const { date, clock } = this.#state.moment.peek() ?? { date: "", clock: "" };
    const fileName = [this.#state.stormId.peek(), date, clock]
      .filter((part) => part !== "")
      .join("-")
      .replace(/[^\w.-]+/g, "");
    return {
      labels: labelsOf(this.#state),
      choice: this.#state.annotations.peek(),
      marks: this.#state.session.marks.peek(),
      fileName,
    };
  }
}

async function annotate(
  { bytes, drawn }: DrawnPicture,
  { labels, choice, marks }: Caption,
): Promise<OffscreenCanvas> {
  const bitmap = await createImageBitmap(new Blob([bytes]));
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d");
  if (context === null) throw new Error("this browser cannot draw on a canvas");
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  const projection = projectionOf(drawn.view);
  if (choice.marks && projection !== undefined) drawMarks(context, marks, projection, canvas);
  const pose = poseOfCamera(drawn.scene?.camera);
  const time = labels.times[drawn.scene?.timeIndex ?? 0];
  const content = annotated(labels, { projection, pose }, time);
  if (content !== undefined) drawAnnotations(context, content, choice, canvas);
  return canvas;
}

function download(bytes: Uint8Array<ArrayBuffer>, name: string, type: string): void {
  const url = URL.createObjectURL(new Blob([bytes], { type }));
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  // The delay gives the browser time to read the data.
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
