// Test support: an in-memory fake of Thunderhead's service with storms, clouds and sessions. Tests
// can make it fail.
import { create } from "@bufbuild/protobuf";
import { Code, ConnectError, type ConnectRouter } from "@connectrpc/connect";
import type { InteractRequest } from "../src/gen/thunderhead/v1/interact_pb";
import { SceneSchema } from "../src/gen/thunderhead/v1/scene_pb";
import { ThunderheadService } from "../src/gen/thunderhead/v1/thunderhead_pb";
import { fakeProbe, fakeStormMap } from "./fake_probe";
import { completeScene, type Draw, describeStorm } from "./fake_scene";
import { type FakePerson, FakeSession } from "./fake_session";
import { FAKE_PRESETS, FAKE_TECHNIQUES } from "./fake_techniques";

// The server's end of one Interact call.
export interface FakeCall {
  receive(request: InteractRequest): void;
  // Reports that the client has left.
  leave(): void;
}

export const END_NOT_SAVED =
  "the session is closed, but exists again if the server restarts before this is saved: the disk is full";

export class FakeService {
  readonly sessions: FakeSession[] = [];
  // If true, the server sends no map.
  mapless = false;
  // The id of a storm that the server cannot describe; empty for none.
  undescribed = "";
  // If true, sessions and their ends are not saved.
  // True while no session can be opened, because the data folders hold no storm.
  empty = false;
  diskFull = false;
  #count = 0;
  #later = 0;
  readonly #storms = [
    { id: "supercell", title: "Supercell that is not there", timeCount: 4, deletable: false },
    { id: "single", title: "One time only", timeCount: 1, deletable: false },
  ];

  // With `tracing`, a resting session sends frames with more and more traced paths. Without it, a
  // resting session sends nothing.
  constructor(
    readonly draw: Draw,
    readonly tracing = false,
  ) {}

  // Adds a time to the supercell, and adds a storm, as if their files had arrived.
  grow(): void {
    this.#later += 1;
    this.#storms.push({ id: "late", title: "Came late", timeCount: 1, deletable: false });
    for (const session of this.sessions) session.catalogueChanged(BigInt(this.#later));
  }

  readonly routes = (router: ConnectRouter): void => {
    router.service(ThunderheadService, {
      getServerInfo: () => ({
        version: "0.1.0-fake",
        glRenderer: "No renderer: drawn by the fake",
        glVersion: "none",
        device: "software",
        maxSessions: 16,
        techniques: FAKE_TECHNIQUES,
        presets: FAKE_PRESETS,
      }),
      listStorms: () => ({ storms: this.#storms }),
      generateCloud: ({ seed }) => {
        const id = `cloud-${seed ?? 1}`;
        const storm = { id, title: "A cloud made up", timeCount: 1, deletable: true };
        this.#storms.push(storm);
        return { storm };
      },
      deleteCloud: ({ stormId }) => {
        const at = this.#storms.findIndex((storm) => storm.id === stormId);
        if (this.#storms[at]?.deletable !== true) {
          throw new ConnectError(`'${stormId}' was not made here`, Code.FailedPrecondition);
        }
        this.#storms.splice(at, 1);
        return {};
      },
      describeStorm: ({ stormId, timeIndex }) => {
        if (stormId === this.undescribed) throw new ConnectError("the file is gone", Code.NotFound);
        return { storm: describeStorm(stormId, timeIndex, this.#later) };
      },
      getStormMap: ({ stormId, timeIndex }) => {
        if (this.mapless) throw new ConnectError("the file is gone", Code.NotFound);
        return fakeStormMap(stormId, timeIndex);
      },
      probeRay: (request) => fakeProbe(request),
      createSession: ({ scene }) => {
        if (this.empty) throw new ConnectError("the server has no storms", Code.NotFound);
        this.#count += 1;
        const session = new FakeSession(
          `presenter-${this.#count}-${process.pid}`,
          `viewer-${this.#count}-${process.pid}`,
          completeScene(scene ?? create(SceneSchema)),
          this.draw,
          this.tracing,
        );
        this.sessions.push(session);
        return {
          sessionId: session.presenterKey,
          viewerKey: session.viewerKey,
          scene: session.scene,
          sceneRevision: session.revision,
          durable: !this.diskFull,
        };
      },
      closeSession: ({ sessionId }) => {
        const session = this.sessions.find(({ presenterKey }) => presenterKey === sessionId);
        if (session === undefined) throw new ConnectError("no such session", Code.NotFound);
        this.end(session, "The presenter has ended the session");
        if (this.diskFull) throw new ConnectError(END_NOT_SAVED, Code.Unavailable);
        return {};
      },
    });
  };

  interact(say: FakePerson["say"], end: FakePerson["end"]): FakeCall {
    let place: { session: FakeSession; person: FakePerson } | undefined;
    return {
      receive: (request) => {
        if (place !== undefined) {
          place.session.receive(place.person, request);
          return;
        }
        const session = this.#joinedBy(request);
        const person = session?.join(request, say, end);
        if (session === undefined || person === undefined) end(Code.NotFound, "no such session");
        else place = { session, person };
      },
      leave: () => place?.session.leave(place.person),
    };
  }

  // Closes a session. With a delay the clients are told to come back, as after a restart of the
  // server.
  end(session: FakeSession, message: string, retryAfterMs?: number): void {
    session.close(message, retryAfterMs);
    if (retryAfterMs === undefined) this.forget(session);
  }

  // Forgets the session, like a server that lost its sessions.
  forget(session: FakeSession): void {
    this.sessions.splice(this.sessions.indexOf(session), 1);
  }

  #joinedBy({ message }: InteractRequest): FakeSession | undefined {
    if (message.case !== "join") return undefined;
    const { sessionKey } = message.value;
    return this.sessions.find(
      ({ presenterKey, viewerKey }) => sessionKey === presenterKey || sessionKey === viewerKey,
    );
  }
}
