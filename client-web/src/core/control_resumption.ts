// Restores control to a person who steered when the connection was lost. After the page has joined
// again, this class decides at each presence message (the list of people and the person in control)
// whether the page takes control again. The server may notice the loss late, so the old connection
// may appear to steer for some seconds.
import { type Presence, Role } from "../gen/thunderhead/v1/interact_pb";

export type Resumption =
  // The page should take control again.
  | "takes"
  // The page may still get control back, so it keeps its unsent edits.
  | "waits"
  // Another viewer steers.
  | "lost";

export interface Before {
  readonly viewerId: bigint;
  readonly steered: boolean;
  readonly people: readonly { readonly viewerId: bigint }[];
}

export class ControlResumption {
  // This person's viewer ids in all connections since this person last steered. The set is empty if
  // this person does not expect to get control back.
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

  // Returns what the page should do after a presence message in which this person does not steer.
  of(presence: Presence, presents: boolean): Resumption {
    if (this.#ownIds.size === 0 || !this.#awaits(presence, presents)) {
      this.end();
      return "lost";
    }
    // The page takes control only once. An older presence message may arrive after the request was
    // sent. A second request could then take control from a colleague who got it meanwhile.
    const takes = presents && this.#takes;
    this.#takes = false;
    return takes ? "takes" : "waits";
  }

  // Ends the resumption, because this person steers again or no longer expects to steer.
  end(): void {
    this.#ownIds.clear();
  }

  // Returns true if this person may still get control back. This is so if no viewer steers, or if
  // this person's lost connection still steers. It is also so if a presenter who was not present
  // before steers, because that presenter reached a restarted server first. A colleague who was
  // present before and took control keeps it.
  #awaits({ steeringViewerId, people }: Presence, presents: boolean): boolean {
    if (steeringViewerId === 0n || this.#ownIds.has(steeringViewerId)) return true;
    const steerer = people.find(({ viewerId }) => viewerId === steeringViewerId);
    const came = steerer?.role === Role.PRESENTER && !this.#known.has(steeringViewerId);
    return presents && this.#takes && came;
  }
}
