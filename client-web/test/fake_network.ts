// Test support: in-memory transports to the fake service, which can fail.
import { create } from "@bufbuild/protobuf";
import { Code, ConnectError, createRouterTransport, type Interceptor } from "@connectrpc/connect";
import { InteractRequestSchema } from "../src/gen/thunderhead/v1/interact_pb";
import type { CallEnd } from "../src/transport/interact_socket";
import { ServerCalls } from "../src/transport/server_calls";
import type { OpenInteract } from "../src/transport/session_client";
import type { FakeService } from "./fake_service";

export class FakeNetwork {
  // If true, no call reaches the server, and open calls receive nothing.
  down = false;
  // If true, the server requires a token.
  locked = false;
  // If true, open calls break as soon as they are joined.
  breaking = false;
  readonly called: string[] = [];
  joins = 0;
  readonly #open = new Set<(end: CallEnd) => void>();

  constructor(readonly service: FakeService) {}

  readonly transport = () => {
    const wire: Interceptor = (next) => async (request) => {
      this.called.push(request.method.name);
      if (this.down) throw new ConnectError("Failed to fetch", Code.Unavailable);
      if (this.locked) throw new ConnectError("this server needs a token", Code.Unauthenticated);
      return next(request);
    };
    const transport = { interceptors: [wire] };
    return createRouterTransport(this.service.routes, { transport });
  };

  calls(): ServerCalls {
    return new ServerCalls(this.transport());
  }

  // Breaks every call with an error, as a network does that reports its failure.
  break(): void {
    this.end({ kind: "broken", message: "The server cannot be reached" });
  }

  end(how: CallEnd): void {
    for (const end of [...this.#open]) end(how);
  }

  readonly openInteract: OpenInteract = (listener) => {
    let over = false;
    const end = (how: CallEnd) => {
      if (over) return;
      over = true;
      this.#open.delete(end);
      call.leave();
      listener.ended(how);
    };
    const call = this.service.interact(
      (message) => queueMicrotask(() => !over && !this.down && listener.message(message)),
      (code, message) =>
        queueMicrotask(() => end({ kind: "status", code, message, retryAfterMs: 0 })),
    );
    this.#open.add(end);
    queueMicrotask(() => {
      if (over) return;
      if (this.down) end({ kind: "broken", message: "The server cannot be reached" });
      else listener.opened();
    });
    return {
      send: (message) => {
        if (over || this.down) return;
        const request = create(InteractRequestSchema, message);
        if (request.message.case === "join") this.joins += 1;
        call.receive(request);
        if (this.breaking)
          queueMicrotask(() => end({ kind: "broken", message: "The server cannot be reached" }));
      },
      cancel: () => {
        over = true;
        this.#open.delete(end);
        call.leave();
      },
    };
  };
}
