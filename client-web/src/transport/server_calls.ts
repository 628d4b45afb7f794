// The page's unary calls to the server, by gRPC-Web.
import type { MessageInitShape } from "@bufbuild/protobuf";
import { type Client, createClient, type Transport } from "@connectrpc/connect";
import type { GenerateCloudRequest } from "../gen/thunderhead/v1/cloud_pb";
import type {
  GetStormMapResponse,
  ProbeRayRequestSchema,
  ProbeRayResponse,
} from "../gen/thunderhead/v1/probe_pb";
import type { Scene } from "../gen/thunderhead/v1/scene_pb";
import type { StormDescription, StormSummary } from "../gen/thunderhead/v1/storm_pb";
import {
  type CreateSessionResponse,
  type GetServerInfoResponse,
  ThunderheadService,
} from "../gen/thunderhead/v1/thunderhead_pb";

const CALL_TIMEOUT_MS = 10_000;
// The server must read the storm before it can compute a map, or choose a camera for a scene
// without camera values.
const SCENE_TIMEOUT_MS = 120_000;
const CLOUD_TIMEOUT_MS = 120_000;

export class ServerCalls {
  readonly #client: Client<typeof ThunderheadService>;
  readonly #life = new AbortController();

  constructor(transport: Transport) {
    this.#client = createClient(ThunderheadService, transport);
  }

  serverInfo(timeoutMs = CALL_TIMEOUT_MS): Promise<GetServerInfoResponse> {
    return this.#client.getServerInfo({}, this.#options(timeoutMs));
  }

  async storms(): Promise<readonly StormSummary[]> {
    return (await this.#client.listStorms({}, this.#options())).storms;
  }

  async describeStorm(stormId: string, timeIndex: number): Promise<StormDescription | undefined> {
    return (await this.#client.describeStorm({ stormId, timeIndex }, this.#options())).storm;
  }

  stormMap(stormId: string, timeIndex: number): Promise<GetStormMapResponse> {
    const request = { stormId, timeIndex, withPlaces: true };
    return this.#client.getStormMap(request, this.#options(SCENE_TIMEOUT_MS));
  }

  probeRay(request: MessageInitShape<typeof ProbeRayRequestSchema>): Promise<ProbeRayResponse> {
    return this.#client.probeRay(request, this.#options());
  }

  async generateCloud(
    request: GenerateCloudRequest,
    signal: AbortSignal,
  ): Promise<StormSummary | undefined> {
    const options = { signal, timeoutMs: CLOUD_TIMEOUT_MS };
    return (await this.#client.generateCloud(request, options)).storm;
  }

  async deleteCloud(stormId: string): Promise<void> {
    await this.#client.deleteCloud({ stormId }, { timeoutMs: CALL_TIMEOUT_MS });
  }

  createSession(scene: Scene): Promise<CreateSessionResponse> {
    return this.#client.createSession({ scene }, this.#options(SCENE_TIMEOUT_MS));
  }

  async closeSession(presenterKey: string): Promise<void> {
    await this.#client.closeSession({ sessionId: presenterKey }, { timeoutMs: CALL_TIMEOUT_MS });
  }

  dispose(): void {
    this.#life.abort();
  }

  #options(timeoutMs = CALL_TIMEOUT_MS): { signal: AbortSignal; timeoutMs: number } {
    return { signal: this.#life.signal, timeoutMs };
  }
}
