// Tests of the gateway with third-party clients from npm: connect-web (as in the page), connect-node, grpc-web and, for
// bidirectional calls, ws. They do not know the gateway, and the gateway does not know their messages.
import assert from "node:assert/strict";
import { once } from "node:events";
import { after, before, describe, test } from "node:test";
import { setTimeout as sleep } from "node:timers/promises";
import { pathToFileURL } from "node:url";
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import { anyPack } from "@bufbuild/protobuf/wkt";
import { Code, ConnectError, createClient, decodeBinaryHeader, encodeBinaryHeader } from "@connectrpc/connect";
import { createGrpcWebTransport as createNodeTransport } from "@connectrpc/connect-node";
import { createGrpcWebTransport as createWebTransport } from "@connectrpc/connect-web";
import WebSocket from "ws";
import xhr2 from "xhr2";
import { startEchoServer } from "./echo_server_process.mjs";

// Imports the code generated from echo.proto and from the server's version of google.rpc.
const generated = (name) => import(pathToFileURL(`${process.env.THUNDERHEAD_GENERATED}/${name}_pb.js`));
const { ConverseRequestSchema, ConverseResponseSchema } = await generated("echo");
const { Echo, SayRequestSchema, SayResponseSchema, FailRequestSchema, WaitRequestSchema } = await generated("echo");
const { StatusSchema } = await generated("google/rpc/status");
const { BadRequestSchema, ErrorInfoSchema, RetryInfoSchema } = await generated("google/rpc/error_details");

// grpc-web is made for browsers; xhr2 provides their XMLHttpRequest in Node.js.
globalThis.XMLHttpRequest = xhr2.XMLHttpRequest ?? xhr2;
const grpcWeb = (await import("grpc-web")).default;

// A longer wait counts as hung.
const HANG_LIMIT_MS = 600_000;

async function eventually(condition) {
  const patience = Date.now() + HANG_LIMIT_MS;
  while (Date.now() < patience) {
    if (await condition()) return;
    await sleep(10);
  }
  assert.fail("what was waited for did not happen");
}

// Returns the server's counts once no call is running: a call that a client has cancelled ends a moment later.
async function recordAtRest(server) {
  let record;
  await eventually(async () => {
    record = await server.record();
    return record.done === record.started;
  });
  return record;
}

// Makes the call with longer and longer deadlines until one leaves it time to reach its handler.
async function longEnough(server, before, call) {
  for (let timeoutMs = 500; (await server.record()).started === before.started; timeoutMs *= 2) {
    assert.ok(timeoutMs < HANG_LIMIT_MS, "no call reached its handler");
    await call(timeoutMs);
  }
}

async function failureOf(promise) {
  try {
    await promise;
  } catch (error) {
    return ConnectError.from(error);
  }
  assert.fail("the call was to fail");
}

async function collect(stream) {
  const all = [];
  for await (const message of stream) all.push(message);
  return all;
}

const transports = {
  "connect-web": (baseUrl) => createWebTransport({ baseUrl }),
  "connect-node": (baseUrl) => createNodeTransport({ baseUrl, httpVersion: "1.1" }),
};

for (const [name, createTransport] of Object.entries(transports)) {
  describe(name, () => {
    let server;
    let client;
    before(async () => {
      server = await startEchoServer();
      client = createClient(Echo, createTransport(server.url));
    });
    after(() => server.stop());

    test("a unary call comes back", async () => {
      const payload = new Uint8Array(100_000).fill(7);
      const response = await client.say({ text: "Gewitter ⛈", payload });
      assert.equal(response.text, "Gewitter ⛈");
      assert.deepEqual(response.payload, payload);
      assert.equal((await client.say({})).text, "");
    });

    test("a stream comes in order", async () => {
      const all = await collect(client.count({ count: 100, payloadBytes: 20_000 }));
      assert.deepEqual(all.map((message) => message.index), [...Array(100).keys()]);
      assert.ok(all.every((message) => message.payload.length === 20_000));
      assert.deepEqual(await collect(client.count({ count: 0 })), []);
    });

    test("messages arrive when they are sent", async () => {
      const before = await recordAtRest(server);
      let seen = 0;
      const leave = new AbortController();
      for await (const _ of client.count({ count: 2, holdAfter: 1 }, { signal: leave.signal })) {
        seen += 1;
        // The server holds the second response back.
        assert.equal((await server.record()).done, before.done, "the first came with the last");
        break;
      }
      assert.equal(seen, 1);
      leave.abort();
    });

    test("an error has its code, message, details and trailers", async () => {
      // The bytes are a google.rpc.Status with the code, the message and no details.
      const details = new Uint8Array([0x08, 5, 0x12, 1, 0x78]);
      const error = await failureOf(client.failOnce({ code: 5, message: "kein Sturm: 100 % ☀\n", details }));
      assert.equal(error.code, Code.NotFound);
      assert.equal(error.metadata.get("failed-after"), "0");
      assert.equal(error.metadata.get("grpc-status-details-bin"), encodeBinaryHeader(details));
      const plain = await failureOf(client.failOnce({ code: 3, message: "kein Sturm: 100 % ☀\n" }));
      assert.equal(plain.code, Code.InvalidArgument);
      assert.equal(plain.rawMessage, "kein Sturm: 100 % ☀\n");
    });

    test("google.rpc's details of an error are found by the client's own means", async () => {
      const message = "scene.time_index ist 4 ☀; storm 'anvil' has times 0 to 3";
      const violation = { field: "scene.time_index", description: "ist 4 ☀; storm 'anvil' has times 0 to 3" };
      const reason = { reason: "VALUE_OUT_OF_RANGE", domain: "thunderhead", metadata: { maximum: "3", minimum: "0" } };
      const details = [
        anyPack(ErrorInfoSchema, create(ErrorInfoSchema, reason)),
        anyPack(RetryInfoSchema, create(RetryInfoSchema, { retryDelay: { seconds: 5n } })),
        anyPack(BadRequestSchema, create(BadRequestSchema, { fieldViolations: [violation] })),
      ];
      const status = toBinary(StatusSchema, create(StatusSchema, { code: 3, message, details }));
      // The calls run one after the other, because a call that fails before the test awaits it ends the program.
      for (const call of [
        () => client.failOnce({ code: 3, message, details: status }),
        () => collect(client.fail({ code: 3, message, messages: 2, details: status })),
      ]) {
        const error = await failureOf(call());
        assert.equal(error.code, Code.InvalidArgument);
        assert.equal(error.rawMessage, message);
        const [info] = error.findDetails(ErrorInfoSchema);
        assert.deepEqual([info.reason, info.domain, { ...info.metadata }], Object.values(reason));
        const [retry] = error.findDetails(RetryInfoSchema);
        assert.equal(retry.retryDelay.seconds, 5n);
        const [request] = error.findDetails(BadRequestSchema);
        const [{ field, description }] = request.fieldViolations;
        assert.deepEqual({ field, description }, violation);
      }
    });

    test("an error in the middle of a stream keeps what came before", async () => {
      const seen = [];
      const error = await failureOf(
        (async () => {
          for await (const message of client.fail({ code: 14, message: "gone", messages: 2 })) seen.push(message.index);
        })(),
      );
      assert.deepEqual(seen, [0, 1]);
      assert.equal(error.code, Code.Unavailable);
      assert.equal(error.rawMessage, "gone");
      assert.equal(error.metadata.get("failed-after"), "2");
    });

    test("metadata goes both ways, binary too", async () => {
      const bytes = new Uint8Array([0, 1, 254, 255]);
      let header;
      let trailer;
      const response = await client.metadata(
        {},
        {
          headers: { "echo-text": "some text", "echo-data-bin": encodeBinaryHeader(bytes) },
          onHeader: (headers) => {
            header = headers;
          },
          onTrailer: (trailers) => {
            trailer = trailers;
          },
        },
      );
      const seen = new Map(response.entries.map((entry) => [entry.name, entry.value]));
      assert.equal(Buffer.from(seen.get("echo-text")).toString(), "some text");
      assert.deepEqual([...seen.get("echo-data-bin")], [...bytes]);
      assert.equal(header.get("echo-text"), "some text");
      assert.deepEqual([...decodeBinaryHeader(header.get("echo-data-bin"))], [...bytes]);
      assert.equal(trailer.get("trailing-echo-text"), "some text");
      assert.deepEqual([...decodeBinaryHeader(trailer.get("trailing-echo-data-bin"))], [...bytes]);
    });

    test("a deadline ends the call on both sides", async () => {
      const before = await recordAtRest(server);
      await longEnough(server, before, async (timeoutMs) => {
        const error = await failureOf(client.wait({}, { timeoutMs }));
        assert.equal(error.code, Code.DeadlineExceeded);
      });
      await eventually(async () => {
        const { started, cancelled, done } = await server.record();
        return done === started && cancelled - before.cancelled === started - before.started;
      });
    });

    test("leaving a stream cancels it", async () => {
      const before = await recordAtRest(server);
      const leave = new AbortController();
      const error = await failureOf(
        (async () => {
          for await (const _ of client.count({ count: 2, intervalMs: 200 }, { signal: leave.signal })) {
            break;
          }
          for await (const _ of client.count({ count: 1, intervalMs: 3_600_000 }, {
            signal: leave.signal,
            onHeader: () => leave.abort(),
          })) {
            assert.fail("nothing was to come");
          }
        })(),
      );
      assert.equal(error.code, Code.Canceled);
      await eventually(async () => {
        const record = await server.record();
        return record.done === before.done + 2 && record.cancelled > before.cancelled;
      });
    });

    test("a request beyond the limit is refused with a reason", async () => {
      const error = await failureOf(client.say({ payload: new Uint8Array(5 << 20) }));
      assert.equal(error.code, Code.ResourceExhausted);
      assert.match(error.rawMessage, /larger than the 4194304 bytes/);
      assert.equal((await client.say({ text: "still there" })).text, "still there");
    });

    test("many calls at once are kept apart", async () => {
      const texts = [...Array(200).keys()].map(String);
      const responses = await Promise.all(texts.map((text) => client.say({ text })));
      assert.deepEqual(responses.map((response) => response.text), texts);
    });
  });
}

// In its binary format grpc-web supports only unary calls: it waits for the whole body. It streams only as
// grpc-web-text, which the gateway does not support.
describe("grpc-web", () => {
  let server;
  let client;
  before(async () => {
    server = await startEchoServer();
    client = new grpcWeb.GrpcWebClientBase({ format: "binary" });
  });
  after(() => server.stop());

  const method = (name, request, response) =>
    new grpcWeb.MethodDescriptor(
      `/thunderhead.gateway.test.Echo/${name}`,
      grpcWeb.MethodType.UNARY,
      Object,
      Object,
      (message) => toBinary(request, message),
      (bytes) => fromBinary(response, bytes),
    );
  // The callback reports the end of the call. The status of a successful call is a separate event, before or after it.
  const call = (descriptor, request, metadata = {}) =>
    new Promise((resolve) => {
      const outcome = {};
      const url = `${server.url}${descriptor.getName()}`;
      const note = (part) => {
        Object.assign(outcome, part);
        if (outcome.error || ("response" in outcome && "status" in outcome)) resolve(outcome);
      };
      const stream = client.rpcCall(url, request, metadata, descriptor, (error, response) => note({ error, response }));
      stream.on("status", (status) => note({ status }));
    });

  test("a unary call comes back", async () => {
    const say = method("Say", SayRequestSchema, SayResponseSchema);
    const payload = new Uint8Array([0, 128, 255]);
    const { error, response, status } = await call(say, create(SayRequestSchema, { text: "Gewitter ⛈", payload }));
    assert.equal(error, null);
    assert.equal(response.text, "Gewitter ⛈");
    assert.deepEqual([...response.payload], [...payload]);
    assert.equal(status.code, 0);
  });

  test("an error has its code and message", async () => {
    const fail = method("FailOnce", FailRequestSchema, SayResponseSchema);
    const { error } = await call(fail, create(FailRequestSchema, { code: 5, message: "no storm, 100 %" }));
    assert.equal(error.code, 5);
    assert.equal(error.message, "no storm, 100 %");
  });

  test("an error that the gateway itself finds is told", async () => {
    const say = method("Say", SayRequestSchema, SayResponseSchema);
    const { error } = await call(say, create(SayRequestSchema, { payload: new Uint8Array(5 << 20) }));
    assert.equal(error.code, 8);
    assert.match(error.message, /larger than/);
  });

  test("a deadline ends the call", async () => {
    const wait = method("Wait", WaitRequestSchema, SayResponseSchema);
    await longEnough(server, await recordAtRest(server), async (timeoutMs) => {
      const deadline = String(Date.now() + timeoutMs);
      const { error } = await call(wait, create(WaitRequestSchema), { deadline });
      assert.equal(error.code, 4);
    });
    await eventually(async () => {
      const record = await server.record();
      return record.done === record.started && record.cancelled === record.started;
    });
  });
});

// The messages have the format of server/gateway/websocket_protocol.h.
describe("ws", () => {
  const [MESSAGE, HALF_CLOSE, TRAILERS] = [0x00, 0x01, 0x80];
  let server;
  before(async () => {
    server = await startEchoServer();
  });
  after(() => server.stop());

  const request = (fields) =>
    Buffer.concat([Buffer.from([MESSAGE]), toBinary(ConverseRequestSchema, create(ConverseRequestSchema, fields))]);
  const open = async (method, options = {}, protocols = ["grpc-websocket.v1"]) => {
    const url = `${server.url.replace("http", "ws")}/thunderhead.gateway.test.Echo/${method}`;
    const socket = new WebSocket(url, protocols, { perMessageDeflate: true, ...options });
    const received = [];
    socket.on("message", (data, isBinary) => received.push({ kind: data[0], payload: data.subarray(1), isBinary }));
    const closed = new Promise((resolve) => socket.on("close", (code) => resolve(code)));
    await once(socket, "open");
    return { socket, received, closed };
  };
  const refusal = async (options, protocols) => {
    try {
      await open("Converse", options, protocols);
    } catch (error) {
      return error.message;
    }
    assert.fail("the upgrade was to be refused");
  };

  test("messages go both ways, then trailers and a normal close", async () => {
    const { socket, received, closed } = await open("Converse");
    assert.equal(socket.protocol, "grpc-websocket.v1");
    assert.equal(socket.extensions, "");
    const payloads = [...Array(300).keys()].map((index) => Buffer.alloc(index * 100, index));
    for (const payload of payloads) socket.send(request({ payload }));
    socket.send(Buffer.from([HALF_CLOSE]));
    assert.equal(await closed, 1000);
    assert.ok(received.every(({ isBinary }) => isBinary));
    const last = received.pop();
    assert.equal(last.kind, TRAILERS);
    assert.equal(last.payload.toString(), "grpc-status:0\r\nconversed:yes\r\n");
    assert.ok(received.every(({ kind }) => kind === MESSAGE));
    const echoed = received.map(({ payload }) => Buffer.from(fromBinary(ConverseResponseSchema, payload).payload));
    assert.deepEqual(echoed, payloads);
  });

  test("an error is trailers", async () => {
    const { socket, received, closed } = await open("Converse");
    socket.send(request({ end: { code: 8, message: "full: 100 % ☀" } }));
    assert.equal(await closed, 1000);
    assert.equal(received.length, 1);
    assert.match(received[0].payload.toString(), /^grpc-status:8\r\ngrpc-message:full: 100 %25 %E2%98%80\r\n/);
  });

  test("closing cancels the call", async () => {
    const before = await recordAtRest(server);
    const { socket, received, closed } = await open("Converse");
    socket.send(request({}));
    await eventually(() => received.length === 1);
    socket.close(1000);
    assert.equal(await closed, 1000);
    await eventually(async () => (await server.record()).cancelled === before.cancelled + 1);
  });

  test("pages of other origins and other subprotocols are refused", async () => {
    assert.match(await refusal({ origin: "http://evil.example" }), /403/);
    assert.match(await refusal({}, ["grpc-websocket.v2"]), /400/);
    const { socket, closed } = await open("Converse", { origin: server.url });
    socket.close();
    await closed;
  });
});
