// Connects the parts of the page: the session with the state, the state with the screen, and keys
// and buttons with both. The page owns the parts, and dispose() ends them.

import type { Transport } from "@connectrpc/connect";
import { effect, untracked } from "@preact/signals-core";
import { AccessToken } from "../core/access_token";
import { BackOff } from "../core/back_off";
import type { CameraKind, Pose } from "../core/camera";
import { isSameDomain, laterByS } from "../core/domain";
import type { TextStore } from "../core/kept_text";
import { Marking } from "../core/marking";
import { type NamedView, NamedViews, VIEWS_ITEM } from "../core/named_views";
import { timeLike } from "../core/nearest_time";
import type { Later } from "../core/newest";
import { OwnKeys } from "../core/own_keys";
import { Participant } from "../core/participant";
import { Playback } from "../core/playback";
import { keepPreferences, loadPreferences } from "../core/preferences";
import { RevisionLedger } from "../core/revision_ledger";
import { withCamera, withRun, withStorm, withTime } from "../core/scene";
import type { Tool } from "../core/session_state";
import { PageState } from "../core/state";
import type { PanelName, ToolName } from "../core/tools";
import { lengthUnits } from "../core/units";
import { ServerCalls } from "../transport/server_calls";
import { type OpenInteract, SessionClient } from "../transport/session_client";
import { Addresses } from "./addresses";
import { Comparing } from "./compare/comparing";
import { learnDecodable } from "./decodable";
import { toggleFullScreen } from "./full_screen";
import { Keeper } from "./keep/keeper";
import { attachKeyboard } from "./keyboard";
import { readLink } from "./link";
import { Notes } from "./notes";
import { Probing } from "./probing";
import { rayMessage } from "./rays";
import { Screen } from "./screen";
import { SessionActions } from "./session_actions";
import { SessionLife } from "./session_life";
import { StormMap } from "./storm_map";
import { StormsOnServer } from "./storms_on_server";
import { Viewpoint } from "./viewpoint";
import { followZones } from "./zones";

// A visible page reports itself this often, so that the session does not expire while the picture
// does not change.
const STILL_HERE_EVERY_MS = 30_000;

export class Page {
  readonly state: PageState;
  readonly playback: Playback;
  readonly marking: Marking;
  readonly actions: SessionActions;
  readonly addresses: Addresses;
  readonly notes: Notes;
  readonly screen: Screen;
  readonly viewpoint: Viewpoint;
  readonly calls: ServerCalls;
  readonly views: NamedViews;
  readonly probing: Probing;
  readonly keeper: Keeper;
  readonly comparing: Comparing;
  readonly #window: Window;
  readonly #token: AccessToken;
  readonly #client: SessionClient;
  readonly #storms: StormsOnServer;
  readonly #map: StormMap;
  readonly #life: SessionLife;
  readonly #listening = new AbortController();
  readonly #disposals: (() => void)[] = [];
  #running = false;
  // The storm that a person last chose on this page; empty before the first choice.
  #chosenStorm = "";

  constructor(
    transport: Transport,
    openInteract: OpenInteract,
    window: Window,
    token = new AccessToken(undefined),
    participant = new Participant(undefined),
    tabStore: TextStore | undefined = undefined,
  ) {
    this.#window = window;
    this.#token = token;
    const nowMs = () => window.performance.now();
    this.state = new PageState(nowMs);
    const { state } = this;
    const { session } = state;
    const link = readLink(window.location.href);
    if (link.scene !== undefined) state.adoptScene(link.scene);
    session.viewerKey.value = link.viewerKey;
    const onNextPaint = (callback: (nowMs: number) => void) => {
      const request = window.requestAnimationFrame(callback);
      return () => window.cancelAnimationFrame(request);
    };
    const later: Later = (delayMs, callback) => {
      const timer = setTimeout(callback, delayMs);
      return () => clearTimeout(timer);
    };
    const store = storageOf(window);
    const keys = new OwnKeys(store);
    const preferred = { units: lengthUnits, annotations: state.annotations };
    loadPreferences(store, preferred);
    this.#disposals.push(effect(() => keepPreferences(store, preferred)));
    const ledger = new RevisionLedger();

    this.notes = new Notes(state);
    this.calls = new ServerCalls(transport);
    this.#storms = new StormsOnServer(this.calls, state);
    this.#map = new StormMap(this.calls, state);
    this.probing = new Probing(this.calls, state);
    this.views = new NamedViews(store, () => state.domain.peek());
    this.keeper = new Keeper(
      transport,
      state,
      this.notes,
      {
        views: () => this.views.at(state.storm.peek()?.times ?? []),
        pausePlayback: () => this.playback.pause(),
      },
      tabStore,
    );
    this.addresses = new Addresses(window, state, keys);
    this.addresses.adoptPresentersLink();
    this.#life = new SessionLife({
      client: () => this.#client,
      screen: () => this.screen,
      viewpoint: () => this.viewpoint,
      marking: () => this.marking,
      state,
      keys,
      ledger,
      notes: this.notes,
      storms: this.#storms,
      pausePlayback: () => this.playback.pause(),
      takeControl: () => this.actions.takeControl(),
      writeAddress: () => this.addresses.write(),
      nowMs,
      onNextPaint,
      later,
    });
    this.#client = new SessionClient(
      this.calls,
      openInteract,
      this.#life,
      this.#life.key,
      new BackOff(),
      participant,
    );
    this.actions = new SessionActions(this.#client, this.calls, keys, state);
    this.screen = new Screen(window, state, ledger, {
      move: (motion) => this.move(motion),
      tool: () => this.marking.tool(),
      clicked: (place) => {
        if (state.tool.peek() === "probe") void this.probing.at(place);
      },
      doubleClicked: (place) => void this.#turnAround(() => this.probing.seenAt(place)),
      acknowledge: (sequence, ownView, lost) => this.#client.acknowledge(sequence, ownView, lost),
      shown: (frame, now) => this.#life.shown(frame, now),
      paced: () => this.#life.adoptOpenCamera(),
      resizeRested: () => {
        this.#life.sendWindow();
        this.#life.sendOutputSize();
      },
      onNextPaint,
    });
    this.viewpoint = new Viewpoint(
      state,
      () => this.#client,
      this.notes,
      () => this.screen.shown?.camera,
      later,
    );
    this.marking = new Marking(session, {
      picture: () => this.screen.markedPicture(),
      point: (ray) =>
        this.#client.send({
          case: "point",
          value: ray === undefined ? {} : { ray: rayMessage(ray) },
        }),
      addMark: (rays) =>
        this.#client.send({ case: "addMark", value: { rays: rays.map(rayMessage) } }),
      later,
    });
    this.playback = new Playback({
      timeCount: () => state.timeCount.value,
      timeIndex: () => state.timeIndex.value,
      isShown: (index) => this.#life.isTimeShown(index),
      showTime: (index, plays) => this.showTime(index, plays ? "unrecorded" : "recorded"),
      onNextPaint,
    });
    this.comparing = new Comparing(this.calls, openInteract, state, {
      move: (motion) => this.move(motion),
      tool: () => this.marking.tool(),
      clicked: (point, picture) => {
        if (state.tool.peek() === "probe") void this.probing.through(point, picture);
      },
      doubleClicked: (point, picture) =>
        void this.#turnAround(() => this.probing.seenThrough(point, picture)),
      changed: () => this.probing.forgetB(),
      onNextPaint,
      later,
    });
    this.#listen();
  }

  // Paints pictures on this canvas from now on. Returns the function that detaches it.
  attachCanvas(canvas: HTMLCanvasElement): () => void {
    const detach = this.screen.attach(canvas);
    if (!this.#running) {
      this.#running = true;
      void this.#run();
    }
    return detach;
  }

  move(motion: (pose: Pose) => Pose): void {
    this.viewpoint.move(motion);
  }

  showCamera(kind: CameraKind): void {
    this.viewpoint.showKind(kind);
  }

  // Shows a named view's camera and time. If the person looks around, only the camera changes,
  // because the own view always has the session's time.
  showView({ camera, validTime, timeIndex }: NamedView): void {
    const { state } = this;
    if (state.session.editBlock.peek() !== undefined) {
      this.viewpoint.show(camera);
      return;
    }
    this.playback.pause();
    const time = timeLike(validTime, timeIndex, state.storm.peek()?.times ?? []);
    state.edit((scene) => withCamera(withTime(scene, time), camera));
  }

  home(): void {
    this.showCamera(this.state.viewPose.value?.kind ?? this.state.cameraKind.value);
  }

  follow(): void {
    this.viewpoint.follow();
  }

  // Stores this token and tries to connect again.
  signIn(token: string): void {
    this.#token.set(token);
    this.state.connection.value = { kind: "connecting" };
    this.#client.retryNow();
  }

  showTime(index: number, record: "recorded" | "unrecorded" = "recorded"): void {
    if (index === this.state.timeIndex.value) return;
    this.state.edit((scene) => withTime(scene, index), record);
  }

  // Shows another storm. A run of the same model keeps the camera, the settings and the valid time.
  // Any other storm is shown at its last time, like the server's default.
  async showStorm(stormId: string): Promise<void> {
    this.playback.pause();
    const { state } = this;
    const before = state.stormId.peek();
    this.#chosenStorm = stormId;
    const listed = state.storms.value.find((storm) => storm.id === stormId);
    const last = Math.max(0, (listed?.timeCount ?? 1) - 1);
    const other = await this.#storms.description(stormId, last);
    // A different storm was chosen meanwhile, on this page, by a file or by another person.
    if (this.#chosenStorm !== stormId || state.stormId.peek() !== before) return;
    const from = state.storm.peek();
    if (from?.id === before && other !== undefined && isSameDomain(from, other)) {
      const index = state.timeIndex.peek();
      const time = timeLike(from.times[index]?.validTime ?? "", index, other.times);
      state.edit((scene) => withRun(scene, stormId, time, laterByS(from, other)));
    } else state.edit((scene) => withStorm(scene, stormId, last));
  }

  // Asks the server to make the cloud set in the panel, and shows the cloud.
  async makeCloud(): Promise<void> {
    const stormId = await this.#storms.makeCloud();
    if (stormId === undefined) return;
    await this.showStorm(stormId);
    if (this.state.stormId.peek() === stormId) this.home();
  }

  stopCloud(): void {
    this.#storms.stopCloud();
  }

  // Deletes the shown cloud for all viewers, and shows another storm.
  async deleteCloud(): Promise<void> {
    const { storms, stormId } = this.state;
    const deleted = stormId.value;
    const other = storms.value.find((storm) => storm.id !== deleted);
    if (other !== undefined) await this.showStorm(other.id);
    await this.#storms.deleteCloud(deleted);
  }

  // Opens a tool in place of the open tool, or closes it. A tool that was opened by a key takes the
  // focus.
  toggleTool(name: ToolName, byKey = false): void {
    const { tool, session } = this.state;
    this.state.toolTakesFocus = byKey;
    const closes = tool.peek() === name;
    if (closes && byKey) this.screen.canvas?.focus();
    tool.value = closes ? undefined : name;
    if (tool.peek() !== "marks" && session.tool.peek() !== "camera") this.#putDown();
  }

  toggleDrawer(): void {
    const { drawerOpen } = this.state;
    drawerOpen.value = !drawerOpen.value;
  }

  togglePopover(name: PanelName): void {
    const { popover } = this.state;
    popover.value = popover.value === name ? undefined : name;
  }

  // Activates a tool that draws or points, or deactivates it if it is active. Does nothing if this
  // person may not mark.
  takeInHand(tool: Exclude<Tool, "camera">): void {
    const { session } = this.state;
    this.marking.withdrawPointer();
    if (!session.mayMark.peek()) return;
    session.tool.value = session.tool.value === tool ? "camera" : tool;
  }

  setResolution(share: number): void {
    this.state.resolution.value = share;
    this.#life.setsOutput = true;
    this.#life.sendOutputSize();
  }

  // Copies the link with which others watch this session.
  copyLink(): Promise<void> {
    return this.#copy(this.addresses.viewersLink(true) ?? "");
  }

  // Copies a link to the view on this screen, even to an own view. The link stays valid after the
  // session has ended.
  copyViewLink(): Promise<void> {
    return this.#copy(this.addresses.viewLink(this.keeper.sceneShown()));
  }

  async #copy(link: string): Promise<void> {
    if (await this.addresses.copy(link)) this.notes.say("link", "Link copied");
    else this.state.notify({ subject: "link", text: link, severity: "note" });
  }

  // Copies the presenter's link. No notice shows the link, because viewers may see the screen and
  // must not learn the key.
  async copyPresentersLink(): Promise<void> {
    const link = this.addresses.presentersLink();
    if (link === undefined) return;
    const copied = await this.addresses.copy(link);
    this.notes.say(
      "link",
      copied
        ? "Presenter's link copied"
        : "The browser does not allow copying. Select the link and copy it yourself.",
    );
  }

  dispose(): void {
    this.#listening.abort();
    for (const dispose of this.#disposals) dispose();
    this.#storms.dispose();
    this.#map.dispose();
    this.probing.dispose();
    this.keeper.dispose();
    this.comparing.dispose();
    this.addresses.dispose();
    this.playback.dispose();
    this.marking.dispose();
    this.viewpoint.dispose();
    this.#life.dispose();
    this.#client.dispose();
    this.calls.dispose();
    this.screen.dispose();
    this.notes.dispose();
  }

  async #run(): Promise<void> {
    const { codecs, whyNoVideo } = await learnDecodable(this.#window);
    this.#life.codecs = codecs;
    this.state.whyNoVideo.value = whyNoVideo;
    await this.#client.run();
  }

  #listen(): void {
    const options = { signal: this.#listening.signal };
    const window = this.#window;
    const { session } = this.state;
    // Opening a presenter's link in place of this session's address changes only the fragment, so
    // the browser does not reload the page.
    window.addEventListener(
      "hashchange",
      () => this.addresses.adoptPresentersLink() && window.location.reload(),
      options,
    );
    window.addEventListener("online", () => this.#client.networkIsBack(), options);
    const sendWindows = () => {
      this.#life.sendWindow();
      this.comparing.sendWindow();
    };
    window.document.addEventListener("visibilitychange", sendWindows, options);
    const storage = (event: StorageEvent) => {
      if (event.key === VIEWS_ITEM) this.views.load();
    };
    window.addEventListener("storage", storage, options);
    this.keeper.listen(window, options);
    this.#disposals.push(
      effect(() => {
        const { server, storm, storms } = this.state;
        const id = storm.value?.id;
        // The movie continues only when the server's description and storms are known, because the
        // movie's texts need them.
        const known = server.value !== undefined && storms.value.length > 0;
        if (id !== undefined && known) untracked(() => this.keeper.resumeMovie(id));
      }),
    );
    const stillHere = setInterval(() => {
      if (!window.document.hidden) sendWindows();
    }, STILL_HERE_EVERY_MS);
    this.#disposals.push(
      () => clearInterval(stillHere),
      attachKeyboard(window, {
        move: (motion) => this.move(motion),
        home: () => this.home(),
        toggleTool: (name) => this.toggleTool(name, true),
        toggleDrawer: () => this.toggleDrawer(),
        togglePanel: (name) => this.togglePopover(name),
        togglePlay: () => this.#mayPlay() && this.playback.toggle(),
        stepTime: (by) => this.#mayPlay() && this.playback.step(by),
        undo: () => this.state.undo(),
        redo: () => this.state.redo(),
        enter: () => {
          if (this.state.tool.peek() !== "probe") return false;
          void this.probing.through({ x: 0, y: 0 });
          return true;
        },
        fullScreen: toggleFullScreen,
        escape: () => this.#escape(),
      }),
      effect(() => {
        void this.state.domain.value;
        untracked(() => this.views.load());
      }),
      followZones(this.state),
      effect(() => this.#storms.describeAfterRest(this.playback.playing.value)),
      effect(() => {
        if (!session.mayLookAround.value) untracked(() => this.follow());
      }),
      effect(() => {
        session.lookingAround.value;
        untracked(() => this.screen.flow.viewChanged());
      }),
      effect(() => {
        if (!session.mayMark.value) session.tool.value = "camera";
      }),
    );
  }

  #mayPlay(): boolean {
    return this.state.session.editBlock.peek() === undefined;
  }

  // Makes the camera turn around the place that `findSeen` returns, such as the place seen under
  // the pointer.
  async #turnAround(
    findSeen: () => Promise<readonly [number, number, number] | undefined>,
  ): Promise<void> {
    try {
      const seen = await findSeen();
      if (seen !== undefined) this.viewpoint.turnAround(seen);
    } catch {
      this.notes.say("target", "The place could not be looked up");
    }
  }

  #putDown(): void {
    this.marking.withdrawPointer();
    this.state.session.tool.value = "camera";
  }

  // Closes the uppermost panel or tool.
  #escape(): boolean {
    const { popover, session, tool, drawerOpen } = this.state;
    if (popover.peek() !== undefined) popover.value = undefined;
    else if (session.tool.peek() !== "camera") this.#putDown();
    else if (drawerOpen.peek()) drawerOpen.value = false;
    else if (tool.peek() !== undefined) this.toggleTool(tool.peek() as ToolName, true);
    else return false;
    return true;
  }
}

// Returns the browser's storage; undefined if the browser denies access to it.
function storageOf(window: Window): Storage | undefined {
  try {
    return window.localStorage;
  } catch {
    return undefined;
  }
}
