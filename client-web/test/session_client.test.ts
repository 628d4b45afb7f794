// Tests of the session client with the in-memory fake service and simulated network failures.
import { create } from "@bufbuild/protobuf";
import { Code } from "@connectrpc/connect";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { BackOff } from "../src/core/back_off";
import { Participant } from "../src/core/participant";
import type { Connection } from "../src/core/state";
import type { Frame } from "../src/gen/thunderhead/v1/frame_pb";
import { type Joined, Role } from "../src/gen/thunderhead/v1/interact_pb";
import { type Scene, SceneSchema } from "../src/gen/thunderhead/v1/scene_pb";
import { type OpenedSession, SessionClient, SILENCE_MS } from "../src/transport/session_client";
import { FakeNetwork } from "./fake_network";
import { FakeService } from "./fake_service";
import type { FakePerson } from "./fake_session";

function follow(network: FakeNetwork, key?: string, random = 1, participant?: Participant) {
  const seen = {
    opened: [] as OpenedSession[],
    joined: [] as Joined[],
    connections: [] as Connection[],
    frames: [] as Frame[],
    scenes: [] as { scene: Scene | undefined; revision: bigint }[],
    refused: [] as { subject: string; code: Code }[],
    gone: [] as { message: string; forgotten: boolean }[],
    scene: create(SceneSchema, { timeIndex: 2 }) as Scene,
    acknowledge: true,
    opensNew: false,
  };
  const client: SessionClient = new SessionClient(
    network.calls(),
    network.openInteract,
    {
      sceneToOpen: () => seen.scene,
      openingRefused: () => undefined,
      opened: (session) => seen.opened.push(session),
      joining: () => ({ name: "Ana", window: { widthPx: 640, heightPx: 360 }, codecs: [] }),
      joined: (joined) => seen.joined.push(joined),
      connection: (connection) => seen.connections.push(connection),
      message: (message) => {
        if (message.case === "scene") {
          const { scene, sceneRevision } = message.value;
          seen.scenes.push({ scene, revision: sceneRevision });
        }
        if (message.case !== "frame") return;
        seen.frames.push(message.value);
        if (seen.acknowledge) client.acknowledge(message.value.sequence, message.value.ownView);
      },
      refused: ({ subject, code }) => void seen.refused.push({ subject, code }),
      gone: (why) => {
        seen.gone.push(why);
        return seen.opensNew;
      },
    },
    key,
    new BackOff(() => random),
    participant,
  );
  return { seen, client };
}

const pass = (ms: number) => vi.advanceTimersByTimeAsync(ms);

describe("the session client", () => {
  const clients: SessionClient[] = [];
  const setUp = () => {
    const service = new FakeService(() => new Uint8Array([1, 2, 3]));
    const network = new FakeNetwork(service);
    const start = (key?: string, random?: number) => {
      const place = follow(network, key, random);
      clients.push(place.client);
      void place.client.run();
      return place;
    };
    const session = () => {
      const first = service.sessions[0];
      if (first === undefined) throw new Error("no session was opened");
      return first;
    };
    return { service, network, start, session };
  };

  beforeEach(() => {
    vi.useFakeTimers();
  });
  afterEach(() => {
    for (const client of clients.splice(0)) client.dispose();
    vi.useRealTimers();
  });

  it("opens a session with the page's scene, joins it as presenter and shows its frames", async () => {
    const { start } = setUp();
    const { seen } = start();
    await pass(300);
    expect(seen.opened).toMatchObject([{ revision: 1n }]);
    expect(seen.opened[0]?.completed.stormId).toBe("supercell");
    expect(seen.joined).toMatchObject([
      { role: Role.PRESENTER, viewerKey: seen.opened[0]?.viewerKey },
    ]);
    expect(seen.scenes[0]?.revision).toBe(1n);
    expect(seen.frames.at(-1)?.refined).toBe(true);
    expect(seen.connections).toEqual([{ kind: "live" }]);
  });

  it("joins with the viewers' key as a viewer, and opens nothing", async () => {
    const { start, session } = setUp();
    start();
    await pass(50);
    const { seen } = start(session().viewerKey);
    await pass(50);
    expect(seen.opened).toEqual([]);
    expect(seen.joined).toMatchObject([{ role: Role.VIEWER }]);
    expect(session().people.map(({ name }) => name)).toEqual(["Ana", "Ana"]);
    expect(seen.frames[0]?.sceneRevision).toBe(1n);
  });

  it("acknowledges, and is sent no third frame before", async () => {
    const { start, session } = setUp();
    const { seen, client } = start();
    seen.acknowledge = false;
    await pass(300);
    for (let i = 0; i < 5; i += 1) {
      await client.updateScene(create(SceneSchema, { timeIndex: i }), BigInt(i + 1));
      await pass(10);
    }
    expect(seen.frames).toHaveLength(2);
    client.acknowledge(seen.frames[1]?.sequence ?? 0n, false);
    await pass(10);
    // Five frames were drawn meanwhile, of which only the newest arrives.
    expect(seen.frames).toHaveLength(3);
    expect(seen.frames[2]?.sceneRevision).toBe(6n);
    expect(session().mostUnacknowledged).toBe(2);
  });

  it("tells scenes that are taken, stale, refused and lost apart", async () => {
    const { start, network } = setUp();
    const { client } = start();
    await pass(300);
    const scene = create(SceneSchema);
    expect(await client.updateScene(scene, 1n)).toEqual({ kind: "taken", revision: 2n });
    expect(await client.updateScene(scene, 1n)).toEqual({ kind: "stale" });
    const wrong = create(SceneSchema, { display: { exposureEv: 50 } });
    expect(await client.updateScene(wrong, 2n)).toEqual({
      kind: "refused",
      message: "display.exposure_ev is 50",
    });
    network.down = true;
    const lost = client.updateScene(scene, 2n);
    network.break();
    await expect(lost).rejects.toThrow();
    await expect(client.updateScene(scene, 2n)).rejects.toThrow();
  });

  it("refuses a viewer's scene, and names any other request that is refused", async () => {
    const { start, session } = setUp();
    start();
    await pass(50);
    const { seen, client } = start(session().viewerKey);
    await pass(50);
    const verdict = await client.updateScene(create(SceneSchema), 1n);
    expect(verdict).toEqual({ kind: "refused", message: "another steers" });
    expect(session().revision).toBe(1n);
    client.send({ case: "takeControl", value: {} });
    await pass(1);
    expect(seen.refused).toEqual([{ subject: "takeControl", code: Code.PermissionDenied }]);
  });

  it("waits longer and longer for a server that is gone, and comes back to the same session", async () => {
    const { start, network, service } = setUp();
    const { seen } = start();
    await pass(2_500);
    network.down = true;
    network.break();
    await pass(32_000);
    const lost = seen.connections.filter((connection) => connection.kind === "lost");
    expect(lost.slice(0, 6).map(({ retryInMs }) => retryInMs)).toEqual([
      1000, 2000, 4000, 8000, 8000, 8000,
    ]);
    expect(lost[0]?.reason).toBe("The server cannot be reached");
    network.down = false;
    await pass(8_000);
    expect(seen.connections.at(-1)).toEqual({ kind: "live" });
    expect(seen.joined).toHaveLength(2);
    expect(seen.opened).toHaveLength(1);
    expect(service.sessions).toHaveLength(1);
  });

  it("spreads the comebacks of a class", async () => {
    const { start, session, network } = setUp();
    start();
    await pass(2_500);
    const [early, late] = [start(session().viewerKey, 0.1), start(session().viewerKey, 0.9)];
    await pass(2_500);
    network.break();
    await pass(1);
    const waits = [early, late].map(({ seen }) => seen.connections.at(-1));
    expect(waits).toMatchObject([{ retryInMs: 100 }, { retryInMs: 900 }]);
  });

  it("does not run hot when every call breaks at once", async () => {
    const { start, network } = setUp();
    start();
    await pass(300);
    network.breaking = true;
    network.joins = 0;
    network.break();
    await pass(60_000);
    expect(network.joins).toBeGreaterThan(5);
    expect(network.joins).toBeLessThan(15);
  });

  it("comes back as the same person, also after a reload, but not to another session", async () => {
    const { network, service } = setUp();
    const kept = new Map<string, string>();
    const store = {
      getItem: (item: string) => kept.get(item) ?? null,
      setItem: (item: string, text: string) => void kept.set(item, text),
    };
    const start = (key?: string) => {
      const place = follow(network, key, 1, new Participant(store));
      clients.push(place.client);
      void place.client.run();
      return place;
    };
    const { seen, client } = start();
    await pass(2_500);
    network.break();
    await pass(2_500);
    const key = seen.joined[0]?.participantKey;
    expect(key).toMatch(/^participant-/);
    expect(seen.joined.map(({ participantKey }) => participantKey)).toEqual([key, key]);
    client.dispose();
    const reloaded = start(seen.opened[0]?.presenterKey);
    await pass(2_500);
    expect(reloaded.seen.joined[0]?.participantKey).toBe(key);
    reloaded.client.dispose();
    const elsewhere = start();
    await pass(2_500);
    expect(elsewhere.seen.joined[0]?.participantKey).not.toBe(key);
    expect(service.sessions).toHaveLength(2);
  });

  it("answers the server that asks whether it is there, and comes back where that came too late", async () => {
    const { start, session } = setUp();
    const { seen } = start();
    await pass(300);
    session().checkAlive();
    await pass(300);
    const [person] = session().people;
    expect(person?.heard.at(-1)?.message.case).toBe("alive");
    session().leave(person as FakePerson);
    person?.end(
      Code.Aborted,
      "this connection did not answer CheckAlive, so another one with its participant_key replaced it; join again",
    );
    await pass(2_500);
    expect(seen.joined).toHaveLength(2);
    expect(seen.connections.at(-1)).toEqual({ kind: "live" });
  });

  it("comes back to a server that restarts after the delay that it gave, and not before", async () => {
    const { start, service, session } = setUp();
    const { seen } = start();
    await pass(2_500);
    service.end(session(), "The server restarts", 3_000);
    await pass(2_999);
    expect(seen.connections.at(-1)).toMatchObject({ kind: "lost", reason: "The server restarts" });
    expect(seen.joined).toHaveLength(1);
    await pass(1_100);
    expect(seen.joined).toHaveLength(2);
    expect(seen.opened).toHaveLength(1);
  });

  it("stops where the session was closed, until it is told to open a new one", async () => {
    const { start, service, session } = setUp();
    const { seen, client } = start();
    await pass(300);
    service.end(session(), "The presenter has ended the session");
    await pass(60_000);
    expect(seen.gone).toMatchObject([
      { message: "The presenter has ended the session", forgotten: false },
    ]);
    expect(seen.connections.at(-1)).toEqual({ kind: "gone" });
    expect(seen.opened).toHaveLength(1);
    client.retryNow();
    await pass(10);
    expect(seen.opened).toHaveLength(1);
    client.openNew();
    await pass(10);
    expect(seen.opened).toHaveLength(2);
    expect(seen.connections.at(-1)).toEqual({ kind: "live" });
  });

  it("opens a new session for one that the server forgot, where the page says so", async () => {
    const { start, service, session, network } = setUp();
    const { seen } = start();
    await pass(300);
    seen.opensNew = true;
    seen.scene = create(SceneSchema, { timeIndex: 3 });
    service.forget(session());
    network.break();
    await pass(1000);
    expect(seen.gone).toMatchObject([{ forgotten: true }]);
    expect(seen.opened).toHaveLength(2);
    expect(seen.opened[1]?.completed.timeIndex).toBe(3);

    const stranger = start("long-gone");
    await pass(60_000);
    expect(stranger.seen.gone).toMatchObject([{ forgotten: true }]);
    expect(stranger.seen.opened).toEqual([]);
  });

  it("does not run hot before a server that loses each session at once", async () => {
    const { start, service } = setUp();
    const open = service.interact;
    vi.spyOn(service, "interact").mockImplementation((say, end) => {
      service.sessions.splice(0);
      return open.call(service, say, end);
    });
    const { seen } = start();
    seen.opensNew = true;
    await pass(60_000);
    expect(seen.opened.length).toBeGreaterThan(5);
    expect(seen.opened.length).toBeLessThan(15);
  });

  it("waits for a token where the server wants one, and goes on with it", async () => {
    const { start, network } = setUp();
    network.locked = true;
    const { seen, client } = start();
    await pass(60_000);
    expect(seen.connections).toEqual([{ kind: "locked", reason: "this server needs a token" }]);
    expect(network.called).toEqual(["CreateSession"]);
    network.locked = false;
    client.retryNow();
    await pass(300);
    expect(seen.connections.at(-1)).toEqual({ kind: "live" });
  });

  it("waits for a token where its call ends for want of one", async () => {
    const { start, network } = setUp();
    const { seen } = start();
    await pass(300);
    network.end({
      kind: "status",
      code: Code.Unauthenticated,
      message: "the token has expired",
      retryAfterMs: 0,
    });
    await pass(60_000);
    expect(seen.connections.at(-1)).toEqual({ kind: "locked", reason: "the token has expired" });
    expect(seen.opened.length).toBe(1);
  });

  it("comes back no sooner than the server asks", async () => {
    const { start, network } = setUp();
    const { seen } = start();
    await pass(300);
    network.end({
      kind: "status",
      code: Code.ResourceExhausted,
      message: "the session is full",
      retryAfterMs: 30_000,
    });
    await pass(29_900);
    expect(network.joins).toBe(1);
    expect(seen.connections.at(-1)).toMatchObject({ kind: "lost", reason: "the session is full" });
    await pass(1_100);
    expect(network.joins).toBe(2);
  });

  it("does not open a session in place of one that cannot be reached", async () => {
    const { start, network, service } = setUp();
    network.down = true;
    const { seen } = start("some-session");
    await pass(60_000);
    network.down = false;
    expect(seen.connections.every(({ kind }) => kind === "lost")).toBe(true);
    expect(network.called).not.toContain("CreateSession");
    expect(service.sessions).toEqual([]);
  });

  it("notices a connection that died without a word", async () => {
    const { start, network } = setUp();
    const { seen } = start();
    await pass(300);
    network.down = true;
    await pass(SILENCE_MS - 200);
    expect(seen.connections.at(-1)).toEqual({ kind: "live" });
    await pass(400);
    expect(seen.connections.at(-1)).toMatchObject({ kind: "lost" });
  });

  it("leaves a silent but living connection alone", async () => {
    const { start, network } = setUp();
    const { seen } = start();
    await pass(SILENCE_MS * 4);
    expect(seen.connections).toEqual([{ kind: "live" }]);
    expect(network.called.filter((name) => name === "GetServerInfo").length).toBeGreaterThan(1);
  });

  it("gives a server up that takes a call and says nothing", async () => {
    const { start, network, service } = setUp();
    const mute = vi.spyOn(service, "interact").mockReturnValue({
      receive: () => undefined,
      leave: () => undefined,
    });
    const { seen } = start();
    await pass(9_900);
    expect(seen.connections).toEqual([]);
    await pass(200);
    expect(seen.connections).toMatchObject([{ kind: "lost" }]);
    mute.mockRestore();
    await pass(2_000);
    expect(seen.connections.at(-1)).toEqual({ kind: "live" });
    expect(network.joins).toBe(2);
  });

  it("tries soon, but not all at once, when the network is back", async () => {
    const { start, network } = setUp();
    const class_ = [0.9, 0.1].map((random) => start(undefined, random));
    await pass(2_500);
    network.down = true;
    network.break();
    await pass(9_000);
    network.down = false;
    for (const { client } of class_) client.networkIsBack();
    await pass(50);
    expect(class_.map(({ seen }) => seen.joined.length)).toEqual([1, 1]);
    await pass(100);
    expect(class_.map(({ seen }) => seen.joined.length)).toEqual([1, 2]);
    await pass(1_000);
    expect(class_.map(({ seen }) => seen.joined.length)).toEqual([2, 2]);
  });

  it("keeps to the delay of a server that restarts, also when the network is back", async () => {
    const { start, service, session } = setUp();
    const { seen, client } = start();
    await pass(2_500);
    service.end(session(), "The server restarts", 3_000);
    await pass(1_000);
    client.networkIsBack();
    await pass(1_990);
    expect(seen.joined).toHaveLength(1);
    await pass(1_100);
    expect(seen.joined).toHaveLength(2);
  });

  it("tries soon to open its first session too", async () => {
    const { start, network } = setUp();
    network.down = true;
    const { seen, client } = start();
    await pass(10_000);
    network.down = false;
    client.networkIsBack();
    await pass(1_100);
    expect(seen.joined).toHaveLength(1);
  });

  it("says nothing and calls nobody after its end", async () => {
    const { start, network, session } = setUp();
    const { seen, client } = start();
    await pass(300);
    client.dispose();
    await pass(10);
    const before = [seen.frames.length, network.called.length, seen.connections.length];
    await pass(20_000);
    expect([seen.frames.length, network.called.length, seen.connections.length]).toEqual(before);
    expect(session().people).toEqual([]);
  });
});
