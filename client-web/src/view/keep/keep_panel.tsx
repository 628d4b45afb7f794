// Saves what is shown as a picture, a scene, a link or a movie, and opens saved files.
import { useEffect, useRef, useState } from "preact/hooks";
import type { PictureSize } from "../../core/camera";
import { clampToLimits } from "../../core/limits";
import { timeInWords } from "../../core/moment";
import { type MovieDraft, pictureCount } from "../../core/movie_plan";
import { LIMITS } from "../../core/scene";
import { formatNumber } from "../../core/units";
import { Choice, NumberInput, Section, Switch } from "../controls";
import { Icon } from "../icons";
import { OnlyHere } from "../only_here";
import type { Page } from "../page";
import { Popover } from "../popover";
import { encodesVideo, NO_VIDEO_ENCODER } from "./encoder";
import { type Refusal, workInWords } from "./keeper";

const SIZES = [
  ["window", "As the window"],
  ["1920x1080", "1920 × 1080"],
  ["3840x2160", "3840 × 2160"],
  ["1080x1080", "1080 × 1080"],
  ["own", "Another size"],
] as const;

type SizeName = (typeof SIZES)[number][0];

export function Keep({ page }: { page: Page }) {
  const { state, keeper } = page;
  const work = keeper.work.value;
  return (
    <Popover page={page} name="keep" title="Save" label="Save what is shown">
      <div class="buttons">
        <button
          type="button"
          data-testid="undo"
          disabled={!state.history.canUndo.value}
          onClick={() => state.undo()}
        >
          <Icon name="undo" /> Undo
        </button>
        <button
          type="button"
          data-testid="redo"
          disabled={!state.history.canRedo.value}
          onClick={() => state.redo()}
        >
          <Icon name="redo" /> Redo
        </button>
      </div>
      {work !== undefined && (
        <div class="work" role="status" data-testid="keep-work">
          <label>
            {workInWords(work)}
            <progress max={1} value={work.share} />
          </label>
          <button type="button" data-testid="keep-cancel" onClick={() => keeper.cancel()}>
            Cancel
          </button>
        </div>
      )}
      <Picture page={page} />
      <Movie page={page} />
      <SceneAndLink page={page} />
    </Popover>
  );
}

// Shows why the request of this section was refused.
function Refused({ page, asked }: { page: Page; asked: Refusal["asked"] }) {
  const refusal = page.keeper.refusal.value;
  if (refusal?.asked !== asked) return null;
  return (
    <p class="unmet" role="alert" data-testid="keep-refused">
      {refusal.why}
    </p>
  );
}

function useSize(page: Page) {
  const [name, setName] = useState<SizeName>("window");
  const [own, setOwn] = useState(page.screen.size);
  const [fixedWidth, fixedHeight] = name === "window" ? [] : name.split("x").map(Number);
  // The size is computed at the time of the request, because the window may have changed since the
  // panel was drawn.
  const size = () => {
    if (name === "own") return own;
    const window = page.screen.size;
    return { widthPx: fixedWidth ?? window.widthPx, heightPx: fixedHeight ?? window.heightPx };
  };
  return { name, setName, own, setOwn, size };
}

function SizeChoice({ testId, chosen }: { testId: string; chosen: ReturnType<typeof useSize> }) {
  const { name, setName, own, setOwn } = chosen;
  return (
    <>
      <Choice label="Size" testId={testId} value={name} options={SIZES} onChange={setName} />
      {name === "own" && (
        <>
          <NumberInput
            label="Width, pixels"
            testId={`${testId}-width`}
            value={own.widthPx}
            onChange={(px) => setOwn({ ...own, widthPx: clampToLimits(px, LIMITS.width) })}
          />
          <NumberInput
            label="Height, pixels"
            testId={`${testId}-height`}
            value={own.heightPx}
            onChange={(px) => setOwn({ ...own, heightPx: clampToLimits(px, LIMITS.height) })}
          />
          <p class="quiet">
            At most {LIMITS.width.maximum} × {LIMITS.height.maximum}.
          </p>
        </>
      )}
    </>
  );
}

function Picture({ page }: { page: Page }) {
  const chosen = useSize(page);
  return (
    <Section title="Picture (PNG)" open testId="keep-picture">
      <SizeChoice testId="picture-size" chosen={chosen} />
      <p class="quiet">
        The picture has the marks, title, time and scales that are chosen under Look. The file
        contains the scene: drop it on this page to see the view again.
      </p>
      <button
        type="button"
        class="primary"
        data-testid="save-picture"
        disabled={page.keeper.work.value !== undefined}
        onClick={() => void page.keeper.savePicture(chosen.size())}
      >
        Save the picture
      </button>
      <Refused page={page} asked="Picture" />
    </Section>
  );
}

const MOVIE = {
  picturesPerSecond: 4,
  picturesPerView: 24,
  alongViews: false,
  format: "webm",
} as const;

function Movie({ page }: { page: Page }) {
  const { state } = page;
  const times = state.storm.value?.times ?? [];
  const last = times.length - 1;
  const chosen = useSize(page);
  const [form, setForm] = useState<Partial<Omit<MovieDraft, "widthPx" | "heightPx">>>({});
  const change = (part: typeof form) => setForm({ ...form, ...part });
  // By default the movie shows the times from the present time to the newest. If the newest time is
  // shown, the movie shows all times.
  const shown = state.timeIndex.value;
  const draft = {
    ...MOVIE,
    ...form,
    from: Math.min(form.from ?? (shown < last ? shown : 0), last),
    to: Math.min(form.to ?? last, last),
  };
  const options = times.map((time, at) => [at, timeInWords(time)] as const);
  const views = page.views.all.value.length;
  return (
    <Section title="Movie" testId="keep-movie">
      <Switch
        label={`Along the ${views} named views`}
        testId="movie-along-views"
        checked={draft.alongViews}
        onChange={(alongViews) => change({ alongViews })}
      />
      {draft.alongViews ? (
        <NumberInput
          label="Pictures between views"
          testId="movie-per-view"
          value={draft.picturesPerView}
          onChange={(value) => change({ picturesPerView: Math.min(240, Math.max(1, value)) })}
        />
      ) : (
        <>
          <Choice
            label="From"
            testId="movie-from"
            value={draft.from}
            options={options}
            onChange={(from) => change({ from })}
          />
          <Choice
            label="To"
            testId="movie-to"
            value={draft.to}
            options={options}
            onChange={(to) => change({ to })}
          />
        </>
      )}
      <NumberInput
        label="Pictures a second"
        testId="movie-rate"
        value={draft.picturesPerSecond}
        onChange={(value) => change({ picturesPerSecond: Math.min(60, Math.max(0.5, value)) })}
      />
      <SizeChoice testId="movie-size" chosen={chosen} />
      <Choice
        label="File"
        testId="movie-format"
        value={draft.format}
        options={[
          ["webm", "WebM"],
          ["mp4", "MP4"],
        ]}
        onChange={(format) => change({ format })}
      />
      {draft.format === "mp4" && encodesVideo() && <Mp4Codec page={page} {...chosen.size()} />}
      <p class="quiet" data-testid="movie-length">
        {lengthInWords(pictureCount(draft, page.views.at(times)), draft.picturesPerSecond)}
      </p>
      <button
        type="button"
        class="primary"
        data-testid="save-movie"
        disabled={
          !encodesVideo() || page.keeper.work.value !== undefined || (draft.alongViews && views < 2)
        }
        onClick={() => void page.keeper.saveMovie({ ...draft, ...chosen.size() })}
      >
        Make the movie
      </button>
      {!encodesVideo() && (
        <p class="unmet" data-testid="movie-impossible">
          Not possible here: {NO_VIDEO_ENCODER}.
        </p>
      )}
      <Refused page={page} asked="Movie" />
    </Section>
  );
}

function Mp4Codec({ page, widthPx, heightPx }: { page: Page } & PictureSize) {
  const [lacksH264, setLacksH264] = useState(false);
  useEffect(() => {
    let wanted = true;
    void page.keeper
      .lacksH264({ widthPx, heightPx })
      .then((lacks) => wanted && setLacksH264(lacks));
    return () => {
      wanted = false;
    };
  }, [page, widthPx, heightPx]);
  if (!lacksH264) return null;
  return (
    <p class="quiet" role="status" data-testid="movie-codec">
      This browser cannot encode H.264 at this size, so the MP4 file contains VP9, which some
      players cannot open.
    </p>
  );
}

function lengthInWords(pictures: number, picturesPerSecond: number): string {
  if (pictures === 1) return "The movie has only one picture, so nothing moves.";
  return `${pictures} pictures, ${formatNumber(pictures / picturesPerSecond)} s.`;
}

function SceneAndLink({ page }: { page: Page }) {
  const file = useRef<HTMLInputElement>(null);
  return (
    <Section title="Scene and link" testId="keep-scene">
      <div class="buttons">
        <button type="button" data-testid="save-scene" onClick={() => page.keeper.saveScene()}>
          Save the scene (JSON)
        </button>
        <button type="button" data-testid="open-file" onClick={() => file.current?.click()}>
          Open a picture or scene
        </button>
        <button type="button" data-testid="keep-link" onClick={() => void page.copyViewLink()}>
          Copy a link to this view
        </button>
      </div>
      <Refused page={page} asked="File" />
      <OnlyHere host={page.addresses.loopbackHost} />
      <input
        ref={file}
        type="file"
        class="visually-hidden"
        tabIndex={-1}
        accept=".png,.json"
        aria-label="Picture or scene to open"
        data-testid="file"
        onChange={(event) => {
          const chosen = event.currentTarget.files?.[0];
          event.currentTarget.value = "";
          if (chosen !== undefined) void page.keeper.open(chosen);
        }}
      />
    </Section>
  );
}
