// Restores control to a person who steered when the connection was lost. Each presence after the
// page has joined again decides. The server may not have noticed the loss yet, so the old
// connection may appear to steer for some seconds.
import { type Presence, Role } from "../gen/thunderhead/v1/interact_pb";

export type Resumption =
  // The page should take control again.
  | "takes"
  // Control is expected back; edits are kept until then.
  | "waits"
  // Another viewer steers.
  | "lost";

export interface Before {
  readonly viewerId: bigint;
  readonly steered: boolean;
  readonly people: readonly { readonly viewerId: bigint }[];
}

export class ControlResumption {
  // This person's ids in the connections since it steered. The set is empty unless control is
  // expected back.
  readonly #ownIds = new Set<bigint>();
  // The people who were present when the connection was lost.
  #known: ReadonlySet<bigint> = new Set();
  #takes = false;

  // Reports that the page has joined again. `before` describes the lost connection.
  rejoined({ viewerId, steered, people }: Before): void {
    if (!steered && this.#ownIds.size === 0) return;
    if (this.#ownIds.size === 0) this.#known = new Set(people.map((person) => person.viewerId));
    this.#ownIds.add(viewerId);
    this.#takes = true;
  }

  // Returns what to do after a presence in which this person does not steer.
  of(presence: Presence, presents: boolean): Resumption {
    if (this.#ownIds.size === 0 || !this.#awaits(presence, presents)) {
      this.end();
      return "lost";
    }
    // Takes control only once. The request may cross with an older presence, and a second request
    // could take control from a colleague who got it afterwards.
    const takes = presents && this.#takes;
    this.#takes = false;
    return takes ? "takes" : "waits";
  }

  // Ends the resumption because this person steers, or no longer expects to.
  end(): void {
    this.#ownIds.clear();
  }

  // Returns true if no viewer steers, or if this person's lost connection still steers. Also
  // returns true if a new presenter got control because that presenter reached a restarted server
  // first. A colleague who was present before and took control keeps it.
  #awaits({ steeringViewerId, people }: Presence, presents: boolean): boolean {
    if (steeringViewerId === 0n || this.#ownIds.has(steeringViewerId)) return true;
    const steerer = people.find(({ viewerId }) => viewerId === steeringViewerId);
    const came = steerer?.role === Role.PRESENTER && !this.#known.has(steeringViewerId);
    return presents && this.#takes && came;
  }
}
