// Keeps the page's scene and the session's the same. Edits are functions of a scene: they are applied to the page's at once,
// sent at most once a screen refresh, a few at a time, and applied again to the server's scene where somebody else changed
// that meanwhile.
import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import type { Later } from "./newest";

export type Edit = (scene: Scene) => Scene;

export type SceneVerdict =
  | { readonly kind: "taken"; readonly revision: bigint }
  // The session's scene is another one than the edits were made to.
  | { readonly kind: "stale" }
  // The server has too much to do; the same scene may be taken later.
  | { readonly kind: "busy"; readonly message: string }
  | { readonly kind: "refused"; readonly message: string };

export interface SyncSteps {
  // The page's scene, with every edit.
  scene(): Scene;
  // Shows a scene in the controls.
  adopt(scene: Scene): void;
  // The server's completed version of the page's own scene.
  complete(scene: Scene): void;
  // Somebody else's scene is in force.
  changedByOthers(scene: Scene, revision: bigint): void;
  // Rejects if the connection is lost.
  send(scene: Scene, expectedRevision: bigint): Promise<SceneVerdict>;
  taken(): void;
  // The revision on which page and server agree may have changed: SceneSync.agreed.
  agreed?(revision: bigint | undefined): void;
  // A scene was refused, or is sent again later as the server is busy.
  refused(message: string): void;
  // Requests one call at the next screen refresh; returns a function that cancels it.
  onNextPaint(callback: () => void): () => void;
  later: Later;
}

// Over a far link a drag does not wait for each answer: 26 scenes a second leave where an answer takes 150 ms.
const MAX_IN_FLIGHT = 4;
const BUSY_REST_MS = 500;
const STALE_REST_MS = 1000;

export class SceneSync {
  readonly #steps: SyncSteps;
  #edits: Edit[] = [];
  // Scenes without an answer.
  #inFlight = 0;
  // Edits were made after the last of them.
  #unsent = false;
  // The revision that the last of them becomes, if all are taken.
  #awaited = -1n;
  // One was not taken, so the others will not be: nothing is sent before all are answered.
  #drains = false;
  #revision = -1n;
  // The newest revision whose scene the server has told, with its defaults filled in.
  #completed = -1n;
  #told: { readonly scene: Scene; readonly revision: bigint } | undefined;
  #mayEdit = false;
  // Nothing is sent before the newer scene is known.
  #stale = false;
  #openingEdits = 0;
  // Another steers: called when edits are given up.
  #onLost: (() => void) | undefined;
  #withdrawPaint: (() => void) | undefined;
  #withdrawRest: (() => void) | undefined;

  constructor(steps: SyncSteps) {
    this.#steps = steps;
  }

  // The revision that the page's scene was made from.
  get revision(): bigint {
    return this.#revision;
  }

  // True while the server has not taken every edit.
  get unsettled(): boolean {
    return this.#edits.length > 0;
  }

  // The revision on which page and server agree: the server has taken every edit and has told the scene that they became.
  // Undefined until then.
  get agreed(): bigint | undefined {
    const known = this.#revision >= 0n && this.#completed >= this.#revision;
    return known && this.#inFlight === 0 && !this.unsettled ? this.#revision : undefined;
  }

  // The page's scene was edited.
  edited(edit: Edit): void {
    this.#edits.push(edit);
    this.#unsent = true;
    // A hand may be faster than the controls, which cannot be used while another steers.
    this.#giveUp();
    this.#schedule();
    this.#tellAgreed();
  }

  // The page's scene is about to open a session.
  opening(): void {
    this.#openingEdits = this.#edits.length;
  }

  // A session was opened with that scene, completed by the server.
  opened(completed: Scene, revision: bigint): void {
    this.#edits.splice(0, this.#openingEdits);
    this.#told = undefined;
    this.#completed = revision;
    this.#rebase(completed, revision);
    this.#tellAgreed();
  }

  // Joined, again or another session: its next scene is taken whatever its revision.
  forget(): void {
    this.#revision = -1n;
    this.#completed = -1n;
    this.#told = undefined;
    this.#endStale();
    this.#tellAgreed();
  }

  // This page steers and is connected.
  allow(): void {
    this.#mayEdit = true;
    this.#onLost = undefined;
    this.#schedule();
  }

  // The connection is lost, or another steers. Edits are kept.
  hold(): void {
    this.#mayEdit = false;
    this.#withdrawPaint?.();
    this.#withdrawPaint = undefined;
  }

  // Another steers: until allow(), gives edits up that the server does not take, and calls `onLost` if there are any. Those that
  // were sent await their answer, as they may have come before the other took control.
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

  // The session's scene.
  told(scene: Scene, revision: bigint): void {
    this.#told = { scene, revision };
    if (revision > this.#completed) this.#completed = revision;
    this.#endStale();
    this.#adoptTold();
    this.#schedule();
    this.#tellAgreed();
  }

  dispose(): void {
    this.hold();
    this.#withdrawRest?.();
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
    if (!this.#stale) return;
    this.#stale = false;
    this.#withdrawRest?.();
    this.#withdrawRest = undefined;
  }

  #rebase(scene: Scene, revision: bigint): void {
    this.#revision = revision;
    this.#endStale();
    this.#steps.adopt(this.#edits.reduce((edited, edit) => edit(edited), scene));
    this.#schedule();
  }

  #maySend(): boolean {
    if (!this.#mayEdit || this.#stale || this.#edits.length === 0) return false;
    if (this.#inFlight === 0) return true;
    // The revision that a further one is made from is known only where the session's is.
    const knows = this.#revision >= 0n && !this.#drains;
    return knows && this.#unsent && this.#inFlight < MAX_IN_FLIGHT;
  }

  #schedule(): void {
    if (!this.#maySend() || this.#withdrawRest !== undefined) return;
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
      // It follows one that was not taken, which said why.
      const follows = this.#drains && verdict.kind === "stale";
      if (verdict.kind !== "taken" || verdict.revision !== expected + 1n) this.#drains = true;
      if (!follows) this.#judge(verdict, sent, scene);
    } catch {
      // The connection is lost: allow() is called once it is back.
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
        // The scene that a later refusal goes back to: the server tells its scene only a few times a second.
        if (this.#told === undefined || this.#told.revision < verdict.revision)
          this.#told = { scene, revision: verdict.revision };
        this.#steps.taken();
        break;
      case "stale":
        // The newer scene is known already, and adopted once all are answered.
        if (this.#told !== undefined && this.#told.revision > this.#revision) break;
        this.#stale = true;
        // Nothing newer is told if the change that was on its way turns out not to be drawable.
        this.#withdrawRest ??= this.#steps.later(STALE_REST_MS, () => {
          this.#withdrawRest = undefined;
          this.#stale = false;
          this.#schedule();
        });
        break;
      case "busy":
        this.#steps.refused(verdict.message);
        this.#withdrawRest = this.#steps.later(BUSY_REST_MS, () => {
          this.#withdrawRest = undefined;
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
