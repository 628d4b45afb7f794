// Synchronizes the page's scene with the session's. Edits are functions of a scene. They are
// applied to the page's scene at once. They are then sent as whole scenes, at most one scene per
// screen refresh, of which at most a few are unanswered. If another viewer has changed the
// session's scene meanwhile, the edits are applied again to that scene.
import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import type { Later } from "./newest";

export type Edit = (scene: Scene) => Scene;

export type SceneVerdict =
  | { readonly kind: "taken"; readonly revision: bigint }
  // The scene is based on an older revision than the session's current scene.
  | { readonly kind: "stale" }
  // The server has too much to do. It may accept the same scene later.
  | { readonly kind: "busy"; readonly message: string }
  | { readonly kind: "refused"; readonly message: string };

export interface SyncSteps {
  // Returns the page's scene, which includes every edit.
  scene(): Scene;
  // Shows a scene in the controls.
  adopt(scene: Scene): void;
  // Passes on the page's own scene, in which the server has filled in the defaults.
  complete(scene: Scene): void;
  // Reports that the session's scene is now one that another viewer has set.
  changedByOthers(scene: Scene, revision: bigint): void;
  // Sends a scene. Rejects if the connection is lost.
  send(scene: Scene, expectedRevision: bigint): Promise<SceneVerdict>;
  taken(): void;
  // Reports that the value of SceneSync.agreed may have changed.
  agreed?(revision: bigint | undefined): void;
  // Reports that a scene was refused, or that it will be sent again because the server is busy.
  refused(message: string): void;
  // Requests one call at the next screen refresh. Returns a function that cancels it.
  onNextPaint(callback: () => void): () => void;
  later: Later;
}

// Several scenes may be in flight, so that a drag over a slow link need not wait for each response.
// At a round trip of 150 ms the page sends 26 scenes a second.
const MAX_IN_FLIGHT = 4;
// If there are more edits than this, they are merged into one edit. They would otherwise accumulate
// while the server does not answer.
const MAX_EDITS = 256;
const BUSY_REST_MS = 500;
const STALE_REST_MS = 1000;

export class SceneSync {
  readonly #steps: SyncSteps;
  #edits: Edit[] = [];
  // Number of unanswered scenes.
  #inFlight = 0;
  // True if edits were made after the last scene was sent.
  #unsent = false;
  // The revision that the last sent scene will get if the server accepts all scenes in flight.
  #awaited = -1n;
  // True after a scene was refused or got an unexpected revision, because the scenes in flight will
  // then be refused, too. Nothing is sent before the server has answered all of them.
  #drains = false;
  #revision = -1n;
  // The newest revision whose scene the server has sent with its defaults filled in.
  #completed = -1n;
  #told: { readonly scene: Scene; readonly revision: bigint } | undefined;
  #mayEdit = false;
  #openingEdits = 0;
  // Set while another viewer steers. The function is called when edits are discarded.
  #onLost: (() => void) | undefined;
  #withdrawPaint: (() => void) | undefined;
  // Set after a refusal as stale. Nothing is sent before the server's newer scene is known.
  #withdrawStale: (() => void) | undefined;
  // Set after a refusal because the server is busy. Nothing is sent meanwhile.
  #withdrawBusy: (() => void) | undefined;

  constructor(steps: SyncSteps) {
    this.#steps = steps;
  }

  // Returns the revision that the page's scene is based on.
  get revision(): bigint {
    return this.#revision;
  }

  // Returns true while the server has not accepted every edit.
  get unsettled(): boolean {
    return this.#edits.length > 0;
  }

  // Returns the revision on which page and server agree. The server has then accepted every edit
  // and has sent the resulting scene. Returns undefined until then.
  get agreed(): bigint | undefined {
    const known = this.#revision >= 0n && this.#completed >= this.#revision;
    return known && this.#inFlight === 0 && !this.unsettled ? this.#revision : undefined;
  }

  // Records an edit of the page's scene.
  edited(edit: Edit): void {
    this.#edits.push(edit);
    if (this.#edits.length > MAX_EDITS) this.#merge();
    this.#unsent = true;
    // Another viewer may already steer while the controls are not disabled yet. The edit is then
    // discarded.
    this.#giveUp();
    this.#schedule();
    this.#tellAgreed();
  }

  #merge(): void {
    const whole = this.#steps.scene();
    this.#edits = [() => whole];
    this.#openingEdits = 0;
  }

  // Records that the page's scene is about to open a session.
  opening(): void {
    this.#openingEdits = this.#edits.length;
  }

  // Records that a session was opened with that scene, which the server completed.
  opened(completed: Scene, revision: bigint): void {
    this.#edits.splice(0, this.#openingEdits);
    this.#told = undefined;
    this.#completed = revision;
    this.#rebase(completed, revision);
    this.#tellAgreed();
  }

  // Forgets the revisions after joining a session. Its next scene is adopted whatever its revision.
  forget(): void {
    this.#revision = -1n;
    this.#completed = -1n;
    this.#told = undefined;
    this.#onLost = undefined;
    this.#endStale();
    this.#endBusy();
    this.#tellAgreed();
  }

  // Allows sending, because this page steers and is connected.
  allow(): void {
    this.#mayEdit = true;
    this.#onLost = undefined;
    this.#schedule();
  }

  // Stops sending, because the connection is lost or another viewer steers. Edits are kept.
  hold(): void {
    this.#mayEdit = false;
    this.#withdrawPaint?.();
    this.#withdrawPaint = undefined;
  }

  // Discards edits while another viewer steers, until allow(). Calls `onLost` if edits are
  // discarded. Scenes in flight wait for their response, because they may have arrived before the
  // other viewer took control.
  discard(onLost: () => void): void {
    this.#onLost = onLost;
    this.#giveUp();
    this.#tellAgreed();
  }

  #giveUp(): void {
    if (this.#onLost === undefined || this.#inFlight > 0 || this.#edits.length === 0) return;
    this.#edits = [];
    this.#unsent = false;
    if (this.#told !== undefined) this.#rebase(this.#told.scene, this.#told.revision);
    this.#onLost();
  }

  // Reports the session's scene and its revision, as the server sent them. A scene that is older
  // than the newest known one is ignored.
  told(scene: Scene, revision: bigint): void {
    if (this.#told !== undefined && revision < this.#told.revision) return;
    this.#told = { scene, revision };
    if (revision > this.#completed) this.#completed = revision;
    if (revision > this.#revision) this.#endStale();
    this.#adoptTold();
    this.#schedule();
    this.#tellAgreed();
  }

  dispose(): void {
    this.hold();
    this.#endStale();
    this.#endBusy();
  }

  #adoptTold(): void {
    const told = this.#told;
    if (told === undefined || this.#inFlight > 0 || told.revision < this.#revision) return;
    if (told.revision === this.#revision) {
      if (this.#edits.length === 0) this.#steps.complete(told.scene);
      return;
    }
    this.#steps.changedByOthers(told.scene, told.revision);
    this.#rebase(told.scene, told.revision);
  }

  #endStale(): void {
    this.#withdrawStale?.();
    this.#withdrawStale = undefined;
  }

  #endBusy(): void {
    this.#withdrawBusy?.();
    this.#withdrawBusy = undefined;
  }

  #rebase(scene: Scene, revision: bigint): void {
    this.#revision = revision;
    this.#endStale();
    this.#steps.adopt(this.#edits.reduce((edited, edit) => edit(edited), scene));
    this.#schedule();
  }

  #maySend(): boolean {
    const rests = this.#withdrawStale !== undefined || this.#withdrawBusy !== undefined;
    if (!this.#mayEdit || rests || this.#edits.length === 0) return false;
    // Every scene states the revision that it is based on. Without it, the last scene would replace
    // what other viewers have changed.
    if (this.#revision < 0n) return false;
    if (this.#inFlight === 0) return true;
    return !this.#drains && this.#unsent && this.#inFlight < MAX_IN_FLIGHT;
  }

  #schedule(): void {
    if (!this.#maySend()) return;
    this.#withdrawPaint ??= this.#steps.onNextPaint(() => {
      this.#withdrawPaint = undefined;
      void this.#send();
    });
  }

  async #send(): Promise<void> {
    if (!this.#maySend()) return;
    const expected = this.#inFlight === 0 ? this.#revision : this.#awaited;
    this.#awaited = expected + 1n;
    this.#inFlight += 1;
    this.#unsent = false;
    const sent = this.#edits.slice();
    const scene = this.#steps.scene();
    try {
      const verdict = await this.#steps.send(scene, expected);
      this.#inFlight -= 1;
      // This scene was stale only because an earlier scene was refused.
      const follows = this.#drains && verdict.kind === "stale";
      if (verdict.kind !== "taken" || verdict.revision !== expected + 1n) this.#drains = true;
      if (!follows) this.#judge(verdict, sent, scene);
    } catch {
      // send() rejects if the connection is lost. Nothing is sent until allow() is called, after
      // the connection is restored.
      this.#inFlight -= 1;
      this.#drains = true;
      this.#onLost = undefined;
      this.hold();
    }
    if (this.#inFlight === 0) this.#drains = false;
    this.#giveUp();
    this.#adoptTold();
    this.#schedule();
    this.#tellAgreed();
  }

  #tellAgreed(): void {
    this.#steps.agreed?.(this.agreed);
  }

  #judge(verdict: SceneVerdict, sent: readonly Edit[], scene: Scene): void {
    switch (verdict.kind) {
      case "taken":
        this.#drop(sent);
        if (verdict.revision > this.#revision) this.#revision = verdict.revision;
        // The server sends its own scene only a few times a second. The accepted scene is therefore
        // remembered as the server's newest scene, to which a later refusal returns.
        if (this.#told === undefined || this.#told.revision < verdict.revision)
          this.#told = { scene, revision: verdict.revision };
        this.#steps.taken();
        break;
      case "stale":
        // The newer scene is already known. It is adopted once all scenes are answered.
        if (this.#told !== undefined && this.#told.revision > this.#revision) break;
        // The newer scene may never arrive, for example if the server cannot draw it. The wait is
        // therefore limited.
        this.#withdrawStale ??= this.#steps.later(STALE_REST_MS, () => {
          this.#withdrawStale = undefined;
          this.#schedule();
        });
        break;
      case "busy":
        this.#steps.refused(verdict.message);
        this.#endBusy();
        this.#withdrawBusy = this.#steps.later(BUSY_REST_MS, () => {
          this.#withdrawBusy = undefined;
          this.#schedule();
        });
        break;
      case "refused":
        this.#drop(sent);
        this.#steps.refused(verdict.message);
        if (this.#told !== undefined && this.#told.revision >= this.#revision)
          this.#rebase(this.#told.scene, this.#told.revision);
        break;
    }
  }

  #drop(sent: readonly Edit[]): void {
    const gone = new Set(sent);
    this.#edits = this.#edits.filter((edit) => !gone.has(edit));
  }
}
