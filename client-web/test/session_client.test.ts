// The session client against the fake service in memory, with simulated network failures.
import { create } from "@bufbuild/protobuf";
import { Code, ConnectError, createRouterTransport, type Interceptor } from "@connectrpc/connect";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Connection } from "../src/core/state";
import type { Frame } from "../src/gen/thunderhead/v1/frame_pb";
import { type Scene, SceneSchema } from "../src/gen/thunderhead/v1/scene_pb";
import { type OpenedSession, SessionClient, SILENCE_MS } from "../src/transport/session_client";
import { FakeService } from "./fake_service";

function setUp(joined?: string) {
  const service = new FakeService(() => new Uint8Array([1, 2, 3]));
  const network = { down: false, failing: "", calls: [] as string[] };
  const wire: Interceptor = (next) => async (request) => {
    network.calls.push(request.method.name);
    if (network.down) throw new ConnectError("Failed to fetch", Code.Unavailable);
    if (network.failing === request.method.name) throw new ConnectError("it broke", Code.Internal);
    return next(request);
  };
  const transport = createRouterTransport(service.routes, { transport: { interceptors: [wire] } });
  const seen = {
    opened: [] as OpenedSession[],
    streams: [] as string[],
    connections: [] as Connection[],
    frames: [] as Frame[],
    scenes: [] as { scene: Scene; revision: bigint }[],
    refused: [] as string[],
    scene: create(SceneSchema, { timeIndex: 2 }) as Scene,
    acknowledge: true,
  };
  const client: SessionClient = new SessionClient(
    transport,
    {
      sceneToOpen: () => seen.scene,
      openingRefused: (message) => seen.refused.push(message),
      opened: (session) => seen.opened.push(session),
      streaming: (id) => seen.streams.push(id),
      connection: (connection) => seen.connections.push(connection),
      scene: (scene, revision) => seen.scenes.push({ scene, revision }),
      frame: (frame) => {
        seen.frames.push(frame);
        if (seen.acknowledge) client.acknowledge(frame.sequence);
      },
      problem: () => undefined,
    },
    joined,
  );
  return { service, network, seen, client };
}

const pass = (ms: number) => vi.advanceTimersByTimeAsync(ms);

describe("the session client", () => {
  const clients: SessionClient[] = [];
  const start = (joined?: string) => {
    const all = setUp(joined);
    clients.push(all.client);
    void all.client.run();
    return all;
  };

  beforeEach(() => {
    vi.useFakeTimers();
  });
  afterEach(() => {
    for (const client of clients.splice(0)) client.dispose();
    vi.useRealTimers();
  });

  it("opens a session with the page's scene and shows its frames", async () => {
    const { seen } = start();
    await pass(300);
    expect(seen.opened).toHaveLength(1);
    expect(seen.opened[0]).toMatchObject({ replaces: false, revision: 1n });
    expect(seen.opened[0]?.completed.stormId).toBe("supercell");
    expect(seen.frames.at(-1)?.refined).toBe(true);
    expect(seen.connections.at(-1)).toEqual({ kind: "live" });
  });

  it("acknowledges by viewer and sequence, and is sent no third frame before", async () => {
    const { seen, service, client } = start();
    seen.acknowledge = false;
    await pass(300);
    for (let i = 0; i < 5; i += 1) {
      await client.updateScene(create(SceneSchema, { timeIndex: i }));
      await pass(10);
    }
    expect(seen.frames).toHaveLength(2);
    client.acknowledge(seen.frames[1]?.sequence ?? 0n);
    await pass(10);
    // Of the five frames drawn meanwhile only the newest arrives.
    expect(seen.frames).toHaveLength(3);
    expect(seen.frames[2]?.sceneRevision).toBe(6n);
    expect(service.mostUnacknowledged).toBe(2);
  });

  it("hands on the session's scene once, and again after a change", async () => {
    const { seen, client } = start();
    await pass(300);
    expect(seen.scenes).toHaveLength(1);
    expect(seen.scenes[0]?.scene.stormId).toBe("supercell");
    expect(seen.scenes[0]?.revision).toBe(1n);
    await client.updateScene(create(SceneSchema, { timeIndex: 3 }));
    await pass(300);
    expect(seen.scenes).toHaveLength(2);
    expect(seen.scenes[1]?.scene.timeIndex).toBe(3);
    expect(seen.scenes[1]?.revision).toBe(2n);
  });

  it("tells a scene that is refused from one that is lost", async () => {
    const { client, network } = start();
    await pass(300);
    const wrong = create(SceneSchema, { display: { exposureEv: 50 } });
    const verdict = await client.updateScene(wrong);
    expect(verdict).toEqual({ kind: "refused", message: "display.exposure_ev is 50" });
    network.down = true;
    await expect(client.updateScene(create(SceneSchema))).rejects.toThrow();
  });

  it("gives a scene up, not the connection, when the server fails at it", async () => {
    const { client, network, seen } = start();
    await pass(300);
    network.failing = "UpdateScene";
    const verdict = await client.updateScene(create(SceneSchema));
    expect(verdict).toEqual({ kind: "refused", message: "it broke" });
    expect(network.calls.filter((name) => name === "UpdateScene")).toHaveLength(2);
    expect(seen.connections).toEqual([{ kind: "live" }]);
  });

  it("does not run hot when every stream breaks at once", async () => {
    const { network, client } = start();
    await pass(300);
    network.failing = "AcknowledgeFrame";
    network.calls.length = 0;
    await client.updateScene(create(SceneSchema));
    await pass(60_000);
    const streams = network.calls.filter((name) => name === "WatchFrames").length;
    expect(streams).toBeGreaterThan(10);
    expect(streams).toBeLessThan(25);
  });

  it("waits longer and longer for a server that is gone, and picks the session up again", async () => {
    const { seen, network, client } = start();
    await pass(300);
    network.down = true;
    await client.updateScene(create(SceneSchema)).catch(() => undefined);
    await pass(12_000);
    const lost = seen.connections.filter((connection) => connection.kind === "lost");
    expect(lost.slice(0, 6).map(({ retryInMs }) => retryInMs)).toEqual([
      250, 500, 1000, 2000, 4000, 4000,
    ]);
    expect(lost[0]?.reason).toBe("The server cannot be reached");
    network.down = false;
    await pass(4_000);
    expect(seen.connections.at(-1)).toEqual({ kind: "live" });
    expect(seen.opened).toHaveLength(1);
    expect(seen.streams).toHaveLength(2);
    expect(new Set(seen.streams).size).toBe(1);
  });

  it("opens a new session with the scene of now when the server lost the old one", async () => {
    const { seen, service } = start();
    await pass(300);
    seen.scene = create(SceneSchema, { timeIndex: 3 });
    service.end(seen.opened[0]?.id ?? "");
    await pass(1000);
    expect(seen.opened).toHaveLength(2);
    expect(seen.opened[1]).toMatchObject({ replaces: true });
    expect(seen.opened[1]?.completed.timeIndex).toBe(3);
    expect(seen.connections.at(-1)).toEqual({ kind: "live" });
  });

  it("joins a session that is there, and opens its own where it is not", async () => {
    const host = start();
    await pass(300);
    const id = host.seen.opened[0]?.id ?? "";
    const guestFrames: Frame[] = [];
    const guest = new SessionClient(
      createRouterTransport(host.service.routes),
      {
        sceneToOpen: () => create(SceneSchema),
        openingRefused: () => undefined,
        opened: () => expect.unreachable("the guest opened a session"),
        streaming: () => undefined,
        connection: () => undefined,
        scene: () => undefined,
        frame: (frame) => guestFrames.push(frame),
        problem: () => undefined,
      },
      id,
    );
    clients.push(guest);
    void guest.run();
    await pass(50);
    expect(guestFrames[0]?.sceneRevision).toBe(1n);

    const stranger = start("long-gone");
    await pass(300);
    expect(stranger.seen.opened).toMatchObject([{ replaces: true }]);
    expect(stranger.seen.connections.at(-1)).toEqual({ kind: "live" });
  });

  it("notices a connection that died without a word", async () => {
    const { seen, network } = start();
    await pass(300);
    network.down = true;
    await pass(SILENCE_MS - 200);
    expect(seen.connections.at(-1)).toEqual({ kind: "live" });
    await pass(400);
    expect(seen.connections.at(-1)).toMatchObject({ kind: "lost" });
  });

  it("leaves a silent but living connection alone", async () => {
    const { seen, network } = start();
    await pass(SILENCE_MS * 4);
    expect(seen.connections).toEqual([{ kind: "live" }]);
    expect(network.calls.filter((name) => name === "GetServerInfo").length).toBeGreaterThanOrEqual(
      2,
    );
  });

  it("tries at once when told that the network is back", async () => {
    const { seen, network, client } = start();
    await pass(300);
    network.down = true;
    await client.updateScene(create(SceneSchema)).catch(() => undefined);
    await pass(5_000);
    network.down = false;
    const before = seen.streams.length;
    client.retryNow();
    await pass(1);
    expect(seen.streams.length).toBe(before + 1);
  });

  it("says nothing and calls nobody after its end", async () => {
    const { seen, network, client } = start();
    await pass(300);
    client.dispose();
    await pass(10);
    const [frames, calls, states] = [
      seen.frames.length,
      network.calls.length,
      seen.connections.length,
    ];
    await pass(20_000);
    expect([seen.frames.length, network.calls.length, seen.connections.length]).toEqual([
      frames,
      calls,
      states,
    ]);
  });
});
