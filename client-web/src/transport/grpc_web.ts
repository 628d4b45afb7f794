// The ways to the server that served the page: gRPC-Web, binary, and a WebSocket for the call that stays.
import type { Transport } from "@connectrpc/connect";
import { createGrpcWebTransport } from "@connectrpc/connect-web";
import { ThunderheadService } from "../gen/thunderhead/v1/thunderhead_pb";
import { openBidi, type Socket, type SocketFactory } from "./interact_socket";
import type { OpenInteract } from "./session_client";

export function createSameOriginTransport(pageUrl: string): Transport {
  const base = new URL(".", pageUrl);
  return createGrpcWebTransport({
    baseUrl: `${base.origin}${base.pathname}`.replace(/\/$/, ""),
  });
}

export function sameOriginInteract(
  pageUrl: string,
  makeSocket: SocketFactory = (url, protocol) => new WebSocket(url, protocol) as Socket,
): OpenInteract {
  const base = new URL(".", pageUrl).href;
  return (listener) => openBidi(ThunderheadService.method.interact, base, makeSocket, listener);
}
