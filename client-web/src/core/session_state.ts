// The session as signals: who is there, who steers, the rules, pointers and marks; and what follows from them for the person
// at this page. Independent of network and document.
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

// A line that was drawn here and is not among the server's marks yet.
export interface PendingMark {
  // Counts those of this page.
  readonly id: number;
  // Of the message that it was sent with last; undefined while it waits to be sent again.
  readonly requestId: bigint | undefined;
  readonly pointsM: readonly Vec3[];
}

export type Tool = "camera" | "pointer" | "pen" | "arrow" | "text";

export class SessionState {
  // The key for viewers' links; undefined before there is a session.
  readonly viewerKey = signal<string | undefined>(undefined);
  // Why the session is over; undefined while it is not.
  readonly ended = signal<string | undefined>(undefined);
  // Kept while the connection is lost.
  readonly me = signal<Me | undefined>(undefined);
  readonly people = signal<readonly Person[]>([]);
  readonly steeringId = signal(0n);
  readonly rules = signal<SessionRules>(create(SessionRulesSchema));
  readonly presenterAway = signal(false);
  // The one who steered and is gone, for whom control waits some seconds.
  readonly awaited = signal<Person | undefined>(undefined);
  readonly pointers = signal<readonly Pointer[]>([]);
  readonly marks = signal<readonly Mark[]>([]);
  readonly pendingMarks = signal<readonly PendingMark[]>([]);
  // True while this page shows a view of its own.
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
  // Nobody steers, and whoever asks gets control at once.
  readonly steersWhoAsks = computed(() => {
    const { viewersMaySteer, controlLocked } = this.rules.value;
    const kept = this.presenterAway.value || this.awaited.value !== undefined;
    const free = this.steeringId.value === 0n && !kept;
    return free && viewersMaySteer === true && controlLocked !== true;
  });
  // True for the people who answer those who ask.
  readonly answersAsking = computed(() => this.steering.value || this.presenting.value);
  readonly mayLookAround = computed(
    () => this.presenting.value || this.rules.value.followingLocked !== true,
  );
  readonly mayMark = computed(
    () =>
      this.me.value !== undefined &&
      (this.presenting.value || this.steering.value || this.rules.value.viewersMayMark === true),
  );
  // Others who get pictures of a view of their own; the server draws for each of them singly.
  readonly othersLookingAround = computed(
    () =>
      this.people.value.filter(
        ({ viewerId, follows, hidden }) => !follows && !hidden && !this.isMe(viewerId),
      ).length,
  );
  readonly alone = computed(() => this.people.value.length < 2);
  // Nothing about who steers need be said.
  readonly steersAlone = computed(
    () => this.steering.value && this.presenting.value && this.alone.value,
  );
  // There is something to say about who steers, or that this page shows a view of its own.
  readonly hasBar = computed(
    () => this.me.value !== undefined && (this.lookingAround.value || !this.steersAlone.value),
  );

  // Why the scene cannot be changed from here; undefined where it can. A scene may be set before the session is there.
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
    return "Nobody steers.";
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

  // The person who points or drew; who has left has no name.
  nameOfId(viewerId: bigint): string {
    const person = this.person(viewerId);
    return person === undefined ? "" : this.nameOf(person);
  }

  // A person who steered before the connection was lost is taken to steer until the next presence, so that controls stay usable.
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

  // Each new mark of one's own takes the place of the pending one that was sent first.
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
