// The named views. A click on a view shows it, and the last button keeps the present view.
import { useState } from "preact/hooks";
import { cameraOfPose } from "../../core/camera";
import { MAX_VIEWS } from "../../core/named_views";
import type { Page } from "../page";

const THUMBNAIL = { widthPx: 128, heightPx: 80 };

export function NamedViews({ page }: { page: Page }) {
  const views = page.views.all.value;
  const [name, setName] = useState<string | undefined>(undefined);
  const keep = () => {
    const pose = page.state.viewPose.peek();
    if (pose === undefined || name === undefined) return;
    const kept = page.views.keep({
      name: name.trim() || page.views.freeName(),
      camera: cameraOfPose(pose),
      validTime: page.state.shownTime.peek()?.validTime ?? "",
      timeIndex: page.state.timeIndex.peek(),
      picture: thumbnail(page.screen.canvas),
    });
    if (!kept)
      page.notes.say(
        "view",
        "The browser's storage is full, so the view is lost when you close this page",
      );
    setName(undefined);
  };
  return (
    <section class="views" aria-label="Named views">
      <h3>Named views</h3>
      <ul>
        {views.map((view) => (
          <li key={view.name}>
            <button
              type="button"
              class="view"
              data-testid="named-view"
              style={view.picture === "" ? {} : { backgroundImage: `url(${view.picture})` }}
              onClick={() => page.showView(view)}
            >
              <span>{view.name}</span>
            </button>
            <button
              type="button"
              class="close"
              aria-label={`Forget ${view.name}`}
              onClick={() => page.views.forget(view.name)}
            >
              ×
            </button>
          </li>
        ))}
      </ul>
      {views.length >= MAX_VIEWS ? (
        <p class="quiet" data-testid="views-full">
          {MAX_VIEWS} views are kept. Forget one to keep another.
        </p>
      ) : name === undefined ? (
        <button
          type="button"
          data-testid="keep-view"
          disabled={page.state.domain.value === ""}
          onClick={() => setName(page.views.freeName())}
        >
          Keep this view
        </button>
      ) : (
        <form
          class="link-row"
          onSubmit={(event) => {
            event.preventDefault();
            keep();
          }}
        >
          <input
            type="text"
            aria-label="Name of the view"
            data-testid="view-name"
            maxLength={40}
            value={name}
            onInput={(event) => setName(event.currentTarget.value)}
          />
          <button type="submit" class="primary">
            Keep
          </button>
        </form>
      )}
    </section>
  );
}

function thumbnail(canvas: HTMLCanvasElement | undefined): string {
  if (canvas === undefined) return "";
  const small = document.createElement("canvas");
  [small.width, small.height] = [THUMBNAIL.widthPx, THUMBNAIL.heightPx];
  const scale = Math.max(small.width / canvas.width, small.height / canvas.height);
  const [width, height] = [canvas.width * scale, canvas.height * scale];
  small
    .getContext("2d")
    ?.drawImage(canvas, (small.width - width) / 2, (small.height - height) / 2, width, height);
  return small.toDataURL("image/jpeg", 0.7);
}
