// Test support: the gateway's bridge from a WebSocket to the fake's Interact.
import { fromBinary, toBinary } from "@bufbuild/protobuf";
import type { WebSocket } from "ws";
import {
  InteractRequestSchema,
  InteractResponseSchema,
} from "../src/gen/thunderhead/v1/interact_pb";
import type { FakeService } from "./fake_service";

const MESSAGE = 0x00;
const HALF_CLOSE = 0x01;
const TRAILERS = 0x80;

export function serveInteract(service: FakeService, socket: WebSocket): void {
  const framed = (kind: number, body: Uint8Array) => Buffer.concat([Buffer.of(kind), body]);
  const call = service.interact(
    (message) => socket.send(framed(MESSAGE, toBinary(InteractResponseSchema, message))),
    (code, message) => {
      const text = `grpc-status: ${code}\r\ngrpc-message: ${encodeURIComponent(message)}\r\n`;
      socket.send(framed(TRAILERS, Buffer.from(text)));
      socket.close(1000);
    },
  );
  socket.on("message", (data: Buffer) => {
    if (data[0] === MESSAGE) call.receive(fromBinary(InteractRequestSchema, data.subarray(1)));
    if (data[0] === HALF_CLOSE) socket.close(1000);
  });
  socket.on("close", () => call.leave());
}
