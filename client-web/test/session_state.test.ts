// Tests of what only the page shows of a session's state, and of the keys that the page keeps. The
// shared cases (tests/clients/cases/session_state.json) test who may do what.
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { AccessToken } from "../src/core/access_token";
import { OwnKeys, trimmedName } from "../src/core/own_keys";
import { Participant } from "../src/core/participant";
import { SessionState } from "../src/core/session_state";
import {
  JoinedSchema,
  MarkSchema,
  MarksSchema,
  type Person,
  PersonSchema,
  PresenceSchema,
  Role,
} from "../src/gen/thunderhead/v1/interact_pb";

const person = (
  viewerId: bigint,
  more: Partial<Pick<Person, "name" | "role" | "asksControl" | "follows" | "hidden">> = {},
) => create(PersonSchema, { viewerId, role: Role.VIEWER, follows: true, ...more });
const TEACHER = person(1n, { name: "Ana", role: Role.PRESENTER });

function joined(viewerId: bigint, role: Role) {
  const session = new SessionState();
  session.viewerKey.value = "viewers";
  session.joined(create(JoinedSchema, { viewerId, role, viewerKey: "viewers" }));
  return session;
}

const marks = (value: MessageInitShape<typeof MarksSchema>) => create(MarksSchema, value);

const presence = (people: Person[], steeringViewerId: bigint, rules = {}) =>
  create(PresenceSchema, { people, steeringViewerId, rules });

describe("a session's state", () => {
  it("lets who opens a session edit before it is there", () => {
    expect(new SessionState().editBlock.value).toBeUndefined();
  });

  it("names who steers as the reason why a viewer cannot edit", () => {
    const session = joined(2n, Role.VIEWER);
    expect(session.editBlock.value).toBe("Joining the session …");
    session.takePresence(presence([TEACHER, person(2n)], 1n));
    expect(session.editBlock.value).toBe("Ana steers.");
    expect(session.steering.value).toBe(false);
    session.takePresence(presence([TEACHER, person(2n)], 2n));
    expect(session.editBlock.value).toBeUndefined();
    expect(session.steering.value).toBe(true);
    session.takePresence(presence([TEACHER, person(2n)], 0n));
    expect(session.editBlock.value).toBe("No one steers.");
  });

  it("keeps the controls of who steered usable while it joins again", () => {
    const session = joined(1n, Role.PRESENTER);
    session.takePresence(presence([TEACHER, person(2n)], 1n));
    session.joined(
      create(JoinedSchema, { viewerId: 9n, role: Role.PRESENTER, viewerKey: "viewers" }),
    );
    expect(session.steering.value).toBe(true);
    session.takePresence(presence([person(9n, { role: Role.PRESENTER }), person(2n)], 2n));
    expect(session.editBlock.value).toBe("Viewer 2 steers.");
  });

  it("has no name for a person who has left", () => {
    expect(joined(2n, Role.VIEWER).nameOfId(99n)).toBe("");
  });

  it("knows who asks, and who answers", () => {
    const session = joined(2n, Role.VIEWER);
    const asking = person(2n, { asksControl: true });
    session.takePresence(presence([TEACHER, asking, person(3n)], 1n));
    expect(session.iAsk.value).toBe(true);
    expect(session.asking.value.map(({ viewerId }) => viewerId)).toEqual([2n]);
    expect(session.answersAsking.value).toBe(false);
    const teacher = joined(1n, Role.PRESENTER);
    teacher.takePresence(presence([TEACHER, asking], 3n));
    expect(teacher.answersAsking.value).toBe(true);
    expect(teacher.iAsk.value).toBe(false);
  });

  it("names the person for whom control is kept", () => {
    const viewer = joined(2n, Role.VIEWER);
    viewer.takePresence({ ...presence([TEACHER, person(2n)], 0n), awaited: person(3n) });
    expect(viewer.editBlock.value).toBe("Control waits for Viewer 3 to come back.");
  });

  it("counts the others for whom the server draws a view of their own", () => {
    const viewer = joined(2n, Role.VIEWER);
    const looks = { follows: false };
    viewer.takePresence(
      presence([TEACHER, person(2n, looks), person(3n, looks), person(4n), person(5n, looks)], 1n),
    );
    expect(viewer.othersLookingAround.value).toBe(2);
    const away = person(5n, { ...looks, hidden: true });
    viewer.takePresence(presence([TEACHER, person(2n, looks), person(3n, looks), away], 1n));
    expect(viewer.othersLookingAround.value).toBe(1);
  });

  it("replaces a pending line by the server's, one by one, not by other people's", () => {
    const session = joined(2n, Role.VIEWER);
    const pending = (requestId: bigint | undefined, id = Number(requestId)) => ({
      id,
      requestId,
      pointsM: [],
    });
    session.pendingMarks.value = [pending(undefined, 4), pending(5n), pending(6n)];
    const others = create(MarkSchema, { markId: 1n, viewerId: 1n });
    session.takeMarks(marks({ marks: [others] }));
    expect(session.pendingMarks.value).toHaveLength(3);
    const own = create(MarkSchema, { markId: 2n, viewerId: 2n });
    session.takeMarks(marks({ marks: [own], onlyChanges: true }));
    // The mark that waits to be sent again is not replaced.
    expect(session.pendingMarks.value).toEqual([pending(undefined, 4), pending(6n)]);
    expect(session.marks.value).toHaveLength(2);
  });

  it("says that it has ended, and forgets who was there", () => {
    const session = joined(1n, Role.PRESENTER);
    session.takePresence(presence([TEACHER], 1n));
    session.end("The session was closed");
    expect(session.editBlock.value).toBe("This session has ended.");
    expect(session.people.value).toEqual([]);
    session.joined(create(JoinedSchema, { viewerId: 1n, role: Role.PRESENTER, viewerKey: "v2" }));
    expect(session.ended.value).toBeUndefined();
  });
});

describe("what the page keeps in the browser", () => {
  function memory() {
    const items = new Map<string, string>();
    return {
      items,
      getItem: (name: string) => items.get(name) ?? null,
      setItem: (name: string, text: string) => void items.set(name, text),
    };
  }

  it("finds the presenter's key by the viewers' key, after a reload too", () => {
    const store = memory();
    new OwnKeys(store).keep("viewers", "presenters");
    const reloaded = new OwnKeys(store);
    expect(reloaded.presenterKey("viewers")).toBe("presenters");
    expect(reloaded.presenterKey("presenters")).toBeUndefined();
    reloaded.forget("viewers");
    expect(new OwnKeys(store).presenterKey("viewers")).toBeUndefined();
  });

  it("keeps a bounded number of keys, the newest", () => {
    const store = memory();
    const keys = new OwnKeys(store);
    for (let i = 0; i < 100; i += 1) keys.keep(`viewers-${i}`, `presenters-${i}`);
    expect(keys.presenterKey("viewers-99")).toBe("presenters-99");
    expect(keys.presenterKey("viewers-0")).toBeUndefined();
    expect([...store.items.values()].join().length).toBeLessThan(2000);
  });

  it("works without storage, and with spoilt storage", () => {
    const denied = new OwnKeys({
      getItem: () => {
        throw new Error("denied");
      },
      setItem: () => {
        throw new Error("denied");
      },
    });
    denied.keep("viewers", "presenters");
    denied.name = "Ana";
    expect(denied.presenterKey("viewers")).toBe("presenters");
    expect(denied.name).toBe("Ana");
    const spoilt = memory();
    spoilt.setItem("thunderhead.presenter-keys", '{"viewers": 1}');
    expect(new OwnKeys(spoilt).presenterKey("viewers")).toBeUndefined();
  });

  it("uses the newest text while the storage is full, and not the older one in it", () => {
    const store = memory();
    const [token, participant, keys] = [
      new AccessToken(store),
      new Participant(store),
      new OwnKeys(store),
    ];
    const keep = (text: string) => {
      token.set(text);
      participant.keep("session", text);
      keys.name = text;
      keys.keep("viewers", text);
    };
    const kept = () => [
      token.value,
      participant.keyFor("session"),
      keys.name,
      keys.presenterKey("viewers"),
    ];
    keep("old");
    const { setItem } = store;
    store.setItem = () => {
      throw new Error("full");
    };
    keep("new");
    expect(kept()).toEqual(["new", "new", "new", "new"]);
    store.setItem = setItem;
    keep("newest");
    expect(kept()).toEqual(["newest", "newest", "newest", "newest"]);
    expect([...store.items.values()].join()).not.toContain("old");
  });

  it("trims a name to forty characters, counted as people count", () => {
    expect(trimmedName("  Ana ")).toBe("Ana");
    expect([...trimmedName("🌩".repeat(50))]).toHaveLength(40);
  });
});
