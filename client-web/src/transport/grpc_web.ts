// The transport to the server that served the page: gRPC-Web, binary, same origin.
import type { Transport } from "@connectrpc/connect";
import { createGrpcWebTransport } from "@connectrpc/connect-web";

export function createSameOriginTransport(pageUrl: string): Transport {
  const base = new URL(".", pageUrl);
  return createGrpcWebTransport({
    baseUrl: `${base.origin}${base.pathname}`.replace(/\/$/, ""),
    fetch: (input, init) => {
      // `keepalive` lets the call that ends a session finish after the page is closed.
      const farewell = String(input).endsWith("/CloseSession");
      return globalThis.fetch(input, farewell ? { ...init, keepalive: true } : init);
    },
  });
}
