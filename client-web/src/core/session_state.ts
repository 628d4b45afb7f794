// The session as signals: the people, the person in control, the rules, pointers and marks, and
// what this person may therefore do. This file does not depend on network or document.
import { create } from "@bufbuild/protobuf";
import { batch, computed, signal } from "@preact/signals-core";
import {
  type Joined,
  type Mark,
  type Marks,
  type Person,
  type Pointer,
  type Presence,
  Role,
  type SessionRules,
  SessionRulesSchema,
} from "../gen/thunderhead/v1/interact_pb";
import type { Vec3 } from "./projection";

export interface Me {
  readonly viewerId: bigint;
  readonly role: Role;
}

// A line that was drawn on this page and is not yet among the server's marks.
export interface PendingMark {
  // Number of the mark on this page.
  readonly id: number;
  // Id of the last message that contained the mark; undefined while it waits to be sent again.
  readonly requestId: bigint | undefined;
  readonly pointsM: readonly Vec3[];
}

export type Tool = "camera" | "pointer" | "pen" | "arrow" | "text";

export class SessionState {
  // The key for viewers' links; undefined before there is a session.
  readonly viewerKey = signal<string | undefined>(undefined);
  // Why the session has ended; undefined while the session exists.
  readonly ended = signal<string | undefined>(undefined);
  // This person. The value is kept while the connection is lost.
  readonly me = signal<Me | undefined>(undefined);
  readonly people = signal<readonly Person[]>([]);
  readonly steeringId = signal(0n);
  readonly rules = signal<SessionRules>(create(SessionRulesSchema));
  readonly presenterAway = signal(false);
  // The person who steered and left, and for whom control is reserved for some seconds.
  readonly awaited = signal<Person | undefined>(undefined);
  readonly pointers = signal<readonly Pointer[]>([]);
  readonly marks = signal<readonly Mark[]>([]);
  readonly pendingMarks = signal<readonly PendingMark[]>([]);
  // True while this page shows its own view.
  readonly lookingAround = signal(false);
  readonly tool = signal<Tool>("camera");

  readonly presenting = computed(() => this.me.value?.role === Role.PRESENTER);
  readonly steering = computed(() => {
    const me = this.me.value;
    return me !== undefined && me.viewerId === this.steeringId.value;
  });
  readonly steerer = computed(() => this.person(this.steeringId.value));
  readonly asking = computed(() => this.people.value.filter((person) => person.asksControl));
  readonly iAsk = computed(() => this.asking.value.some((person) => this.isMe(person.viewerId)));
  // True if a viewer who asks for control gets it at once, because no viewer steers.
  readonly steersWhoAsks = computed(() => {
    const { viewersMaySteer, controlLocked } = this.rules.value;
    const kept = this.presenterAway.value || this.awaited.value !== undefined;
    const free = this.steeringId.value === 0n && !kept;
    return free && viewersMaySteer === true && controlLocked !== true;
  });
  // True if this person may answer requests for control.
  readonly answersAsking = computed(() => this.steering.value || this.presenting.value);
  readonly mayLookAround = computed(
    () => this.presenting.value || this.rules.value.followingLocked !== true,
  );
  readonly mayMark = computed(
    () =>
      this.me.value !== undefined &&
      (this.presenting.value || this.steering.value || this.rules.value.viewersMayMark === true),
  );
  // Number of other people with an own view. The server draws each of these views separately.
  readonly othersLookingAround = computed(
    () =>
      this.people.value.filter(
        ({ viewerId, follows, hidden }) => !follows && !hidden && !this.isMe(viewerId),
      ).length,
  );
  readonly alone = computed(() => this.people.value.length < 2);
  // True if this person is the only one in the session, presents and steers, so that the page need
  // not show who is in control.
  readonly steersAlone = computed(
    () => this.steering.value && this.presenting.value && this.alone.value,
  );
  // True if the session bar is needed. The bar shows the person in control, or that this page shows
  // an own view.
  readonly hasBar = computed(
    () => this.me.value !== undefined && (this.lookingAround.value || !this.steersAlone.value),
  );

  // Why this page cannot change the scene; undefined if it can. The scene may be changed before the
  // session exists.
  readonly editBlock = computed((): string | undefined => {
    if (this.ended.value !== undefined) return "This session has ended.";
    if (this.steering.value) return undefined;
    if (this.me.value === undefined)
      return this.viewerKey.value === undefined ? undefined : "Joining the session …";
    if (this.person(this.me.value.viewerId) === undefined) return "Joining the session …";
    const steerer = this.steerer.value;
    if (steerer !== undefined) return `${this.nameOf(steerer)} steers.`;
    const awaited = this.awaited.value;
    if (awaited !== undefined) return `Control waits for ${this.nameOf(awaited)} to come back.`;
    if (this.presenterAway.value) return "The presenter is away, and keeps control.";
    return "No one steers.";
  });

  person(viewerId: bigint): Person | undefined {
    return this.people.value.find((person) => person.viewerId === viewerId);
  }

  isMe(viewerId: bigint): boolean {
    return this.me.value?.viewerId === viewerId;
  }

  nameOf(person: Pick<Person, "name" | "role" | "viewerId">): string {
    if (person.name !== "") return person.name;
    return person.role === Role.PRESENTER ? "Presenter" : `Viewer ${person.viewerId}`;
  }

  // Returns the name of a person who points or drew; empty for a person who has left.
  nameOfId(viewerId: bigint): string {
    const person = this.person(viewerId);
    return person === undefined ? "" : this.nameOf(person);
  }

  // Handles joining. If this person steered before the connection was lost, the page assumes until
  // the next presence message that this person steers. The controls therefore stay usable.
  joined(joined: Joined): void {
    const steered = this.steering.peek();
    batch(() => {
      this.ended.value = undefined;
      this.me.value = { viewerId: joined.viewerId, role: joined.role };
      this.viewerKey.value = joined.viewerKey;
      this.steeringId.value = steered ? joined.viewerId : 0n;
      this.pointers.value = [];
      this.marks.value = [];
      this.pendingMarks.value = [];
    });
  }

  takePresence(presence: Presence): void {
    batch(() => {
      this.people.value = presence.people;
      this.steeringId.value = presence.steeringViewerId;
      this.presenterAway.value = presence.presenterAway;
      this.awaited.value = presence.awaited;
      if (presence.rules !== undefined) this.rules.value = presence.rules;
    });
  }

  // Takes the marks from the server. Each new mark of this person replaces the oldest pending mark
  // that was sent.
  takeMarks(told: Marks): void {
    const before = this.marks.value;
    const known = new Set(before.map((mark) => mark.markId));
    const fresh = told.marks.filter((mark) => !known.has(mark.markId) && this.isMe(mark.viewerId));
    const pending = this.pendingMarks.value;
    const placed = pending.filter((mark) => mark.requestId !== undefined).slice(0, fresh.length);
    batch(() => {
      this.marks.value = told.onlyChanges ? changed(before, told) : told.marks;
      this.pendingMarks.value = pending.filter((mark) => !placed.includes(mark));
    });
  }

  end(reason: string): void {
    batch(() => {
      this.ended.value = reason;
      this.me.value = undefined;
      this.people.value = [];
      this.steeringId.value = 0n;
      this.awaited.value = undefined;
      this.pointers.value = [];
      this.pendingMarks.value = [];
      this.lookingAround.value = false;
    });
  }
}

function changed(before: readonly Mark[], { marks, erasedMarkIds }: Marks): readonly Mark[] {
  const erased = new Set(erasedMarkIds);
  const after = new Map(before.map((mark) => [mark.markId, mark]));
  for (const mark of marks) after.set(mark.markId, mark);
  return [...after.values()].filter(({ markId }) => !erased.has(markId));
}
