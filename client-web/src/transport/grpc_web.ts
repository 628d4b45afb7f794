// The transports to the server that served the page: binary gRPC-Web, and a WebSocket for the
// long-lived call.
import type { Interceptor, Transport } from "@connectrpc/connect";
import { createGrpcWebTransport } from "@connectrpc/connect-web";
import { ThunderheadService } from "../gen/thunderhead/v1/thunderhead_pb";
import { openBidi, type Socket, type SocketFactory } from "./interact_socket";
import type { OpenInteract } from "./session_client";

// Returns the token that calls send; undefined if calls send no token.
export type TokenSource = () => string | undefined;

export function createSameOriginTransport(pageUrl: string, token: TokenSource): Transport {
  const base = new URL(".", pageUrl);
  const showToken: Interceptor = (next) => (request) => {
    const shown = token();
    if (shown !== undefined) request.header.set("authorization", `Bearer ${shown}`);
    return next(request);
  };
  return createGrpcWebTransport({
    baseUrl: `${base.origin}${base.pathname}`.replace(/\/$/, ""),
    interceptors: [showToken],
  });
}

export function sameOriginInteract(
  pageUrl: string,
  token: TokenSource,
  makeSocket: SocketFactory = (url, protocols) => new WebSocket(url, protocols) as Socket,
): OpenInteract {
  const base = new URL(".", pageUrl).href;
  return (listener) =>
    openBidi(ThunderheadService.method.interact, base, token(), makeSocket, listener);
}
