// Tests the framing of a bidirectional call over a real WebSocket.
import { once } from "node:events";
import type { AddressInfo } from "node:net";
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import { anyPack } from "@bufbuild/protobuf/wkt";
import { Code } from "@connectrpc/connect";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { WebSocket, WebSocketServer } from "ws";
import { RetryInfoSchema } from "../src/gen/google/rpc/error_details_pb";
import { StatusSchema } from "../src/gen/google/rpc/status_pb";
import {
  InteractRequestSchema,
  type InteractResponse,
  InteractResponseSchema,
} from "../src/gen/thunderhead/v1/interact_pb";
import { sameOriginInteract } from "../src/transport/grpc_web";
import type { CallEnd, Socket } from "../src/transport/interact_socket";

describe("a call over a WebSocket", () => {
  let server: WebSocketServer;
  const heard: {
    path: string | undefined;
    protocol: string;
    offered: string | undefined;
    messages: Buffer[];
  } = {
    path: undefined,
    protocol: "",
    offered: undefined,
    messages: [],
  };

  beforeEach(async () => {
    server = new WebSocketServer({ port: 0, host: "127.0.0.1" });
    heard.messages = [];
    await once(server, "listening");
  });
  afterEach(() => {
    for (const client of server.clients) client.terminate();
    server.close();
  });

  function open(base = "/below/a/path/index.html", token?: string) {
    const { port } = server.address() as AddressInfo;
    const seen = { opened: 0, messages: [] as InteractResponse[], ends: [] as CallEnd[] };
    let socket: WebSocket | undefined;
    const makeSocket = (url: string, protocols: string[]) => {
      socket = new WebSocket(url, protocols);
      return socket as unknown as Socket;
    };
    const openInteract = sameOriginInteract(
      `http://127.0.0.1:${port}${base}?session=1`,
      () => token,
      makeSocket,
    );
    const call = openInteract({
      opened: () => {
        seen.opened += 1;
      },
      message: (message) => seen.messages.push(message),
      ended: (end) => seen.ends.push(end),
    });
    return { call, seen, isClosed: () => socket?.readyState === WebSocket.CLOSED };
  }

  async function accepted(): Promise<WebSocket> {
    const [socket, request] = (await once(server, "connection")) as [
      WebSocket,
      { url: string; headers: Record<string, string> },
    ];
    heard.path = request.url;
    heard.offered = request.headers["sec-websocket-protocol"];
    heard.protocol = socket.protocol;
    socket.on("message", (data: Buffer) => heard.messages.push(data));
    return socket;
  }

  const until = async (holds: () => boolean) => {
    // The test's own timeout ends a wait that never succeeds.
    while (!holds()) await new Promise((r) => setTimeout(r, 5));
  };

  it("shows its token beside the protocol's name", async () => {
    open("/", "storm?>~");
    await accepted();
    expect(heard.offered).toBe("grpc-websocket.v1,bearer.c3Rvcm0_Pn4");
  });

  it("reads from the trailers when to try again", async () => {
    const { seen } = open();
    const socket = await accepted();
    const retry = anyPack(
      RetryInfoSchema,
      create(RetryInfoSchema, { retryDelay: { seconds: 12n } }),
    );
    const details = toBinary(StatusSchema, create(StatusSchema, { details: [retry] }));
    const trailers = `grpc-status: 8\r\ngrpc-message: full\r\ngrpc-status-details-bin: ${Buffer.from(details).toString("base64").replaceAll("=", "")}\r\n`;
    socket.send(Buffer.concat([Buffer.of(0x80), Buffer.from(trailers)]));
    await until(() => seen.ends.length === 1);
    expect(seen.ends).toEqual([{ kind: "status", code: 8, message: "full", retryAfterMs: 12_000 }]);
  });

  it("asks below the page's path by the protocol's name, and frames messages", async () => {
    const { call, seen } = open();
    const socket = await accepted();
    await until(() => seen.opened === 1);
    expect(heard.path).toBe("/below/a/path/thunderhead.v1.ThunderheadService/Interact");
    expect(heard.protocol).toBe("grpc-websocket.v1");
    call.send({ requestId: 7n, message: { case: "takeControl", value: {} } });
    await until(() => heard.messages.length === 1);
    const [sent] = heard.messages;
    expect(sent?.[0]).toBe(0);
    const request = fromBinary(InteractRequestSchema, sent?.subarray(1) ?? new Uint8Array());
    expect([request.requestId, request.message.case]).toEqual([7n, "takeControl"]);

    const joined = create(InteractResponseSchema, {
      message: { case: "joined", value: { viewerId: 3n } },
    });
    socket.send(Buffer.concat([Buffer.of(0), toBinary(InteractResponseSchema, joined)]));
    await until(() => seen.messages.length === 1);
    expect(seen.messages[0]?.message).toMatchObject({ case: "joined", value: { viewerId: 3n } });
  });

  it("takes the status from the trailers, whatever comes after", async () => {
    const { seen, isClosed } = open();
    const socket = await accepted();
    const trailers = "grpc-status: 5\r\ngrpc-message: no session %22x%22%3A gone\r\nother: 1\r\n";
    socket.send(Buffer.concat([Buffer.of(0x80), Buffer.from(trailers)]));
    socket.close(1000);
    await until(isClosed);
    expect(seen.ends).toEqual([
      {
        kind: "status",
        code: Code.NotFound,
        message: 'no session "x": gone',
        retryAfterMs: 0,
      },
    ]);
  });

  it("is broken where the socket closes without trailers", async () => {
    const { seen } = open();
    (await accepted()).close(1001);
    await until(() => seen.ends.length === 1);
    const ruled = open();
    (await accepted()).close(1008, "too many messages");
    await until(() => ruled.seen.ends.length === 1);
    const cut = open();
    (await accepted()).terminate();
    await until(() => cut.seen.ends.length === 1);
    expect([seen, ruled.seen, cut.seen].map(({ ends }) => ends[0])).toEqual([
      { kind: "broken", message: "The server is stopping" },
      { kind: "broken", message: "The server closed the connection: too many messages" },
      { kind: "broken", message: "The server cannot be reached" },
    ]);
  });

  it("half-closes when it is cancelled, and says no more", async () => {
    const { call, seen } = open();
    const socket = await accepted();
    await until(() => seen.opened === 1);
    call.cancel();
    await once(socket, "close");
    call.send({ message: { case: "follow", value: {} } });
    expect(heard.messages.map((message) => [...message])).toEqual([[1]]);
    expect(seen.ends).toEqual([]);
  });
});
