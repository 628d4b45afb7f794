// The way back to control for somebody who steered when the connection was lost: each presence after joining again decides. The server may
// not know yet that the old connection is lost, and then sees it steer for some seconds.
import { type Presence, Role } from "../gen/thunderhead/v1/interact_pb";

export type Resumption =
  // Control is to be taken again.
  | "takes"
  // Control is on its way back; edits are kept until then.
  | "waits"
  // Another steers.
  | "lost";

export interface Before {
  readonly viewerId: bigint;
  readonly steered: boolean;
  readonly people: readonly { readonly viewerId: bigint }[];
}

export class ControlResumption {
  // This person's ids in the connections since it steered; empty unless control is expected back.
  readonly #ownIds = new Set<bigint>();
  // The people who were there when the connection was lost.
  #known: ReadonlySet<bigint> = new Set();
  #takes = false;

  // Joined again; `before` is of the connection that was lost.
  rejoined({ viewerId, steered, people }: Before): void {
    if (!steered && this.#ownIds.size === 0) return;
    if (this.#ownIds.size === 0) this.#known = new Set(people.map((person) => person.viewerId));
    this.#ownIds.add(viewerId);
    this.#takes = true;
  }

  // Of a presence in which this person does not steer.
  of(presence: Presence, presents: boolean): Resumption {
    if (this.#ownIds.size === 0 || !this.#awaits(presence, presents)) {
      this.end();
      return "lost";
    }
    // Once: it may cross with a presence that is older, and must not take control from a colleague who came after it.
    const takes = presents && this.#takes;
    this.#takes = false;
    return takes ? "takes" : "waits";
  }

  // This person steers, or no longer expects to.
  end(): void {
    this.#ownIds.clear();
  }

  // Where nobody steers or this person's lost connection does, and where a presenter got control for having come first to a
  // server that started again. A colleague who was there and took it keeps it.
  #awaits({ steeringViewerId, people }: Presence, presents: boolean): boolean {
    if (steeringViewerId === 0n || this.#ownIds.has(steeringViewerId)) return true;
    const steerer = people.find(({ viewerId }) => viewerId === steeringViewerId);
    const came = steerer?.role === Role.PRESENTER && !this.#known.has(steeringViewerId);
    return presents && this.#takes && came;
  }
}
