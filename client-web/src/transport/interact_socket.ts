// A bidirectional gRPC call over one WebSocket, which the server's gateway connects to the gRPC
// service. Each WebSocket message is a byte for its kind, followed by a message of the call. The
// last WebSocket message contains the status as trailers. This code works for any message types.
import {
  create,
  type DescMessage,
  fromBinary,
  type MessageInitShape,
  type MessageShape,
  toBinary,
} from "@bufbuild/protobuf";
import { Code } from "@connectrpc/connect";
import { retryAfterMsOfTrailer } from "./retry_info";

// The part of the DOM's WebSocket that this code uses.
export interface Socket {
  binaryType: string;
  readonly readyState: number;
  onopen: ((event: never) => void) | null;
  onmessage: ((event: { data: unknown }) => void) | null;
  onclose: ((event: { code: number; reason: string }) => void) | null;
  send(bytes: Uint8Array<ArrayBuffer>): void;
  close(code?: number): void;
}

export type SocketFactory = (url: string, protocols: string[]) => Socket;

// A bidirectional gRPC method: its name and message types, as in the generated descriptors.
export interface BidiMethod<I extends DescMessage, O extends DescMessage> {
  readonly name: string;
  readonly parent: { readonly typeName: string };
  readonly input: I;
  readonly output: O;
}

export type CallEnd =
  // The server answered with a status.
  | {
      readonly kind: "status";
      readonly code: Code | 0;
      readonly message: string;
      // Delay before a retry that the server asks for; 0 if it asks for none.
      readonly retryAfterMs: number;
    }
  // The connection was lost, or could not be made.
  | { readonly kind: "broken"; readonly message: string };

export interface BidiListener<O extends DescMessage> {
  opened(): void;
  message(message: MessageShape<O>): void;
  // Reports the end of the call. This is the last callback, and it is never called after cancel().
  ended(end: CallEnd): void;
}

export interface BidiCall<I extends DescMessage> {
  // Sends a message. Drops the message while the connection is not open.
  send(message: MessageInitShape<I>): void;
  // Ends the call without waiting for the server's status.
  cancel(): void;
}

const PROTOCOL = "grpc-websocket.v1";
const TOKEN_PREFIX = "bearer.";
const MESSAGE = 0x00;
const HALF_CLOSE = 0x01;
const TRAILERS = 0x80;
const OPEN = 1;
const NORMAL_CLOSURE = 1000;
const GOING_AWAY = 1001;

export function openBidi<I extends DescMessage, O extends DescMessage>(
  method: BidiMethod<I, O>,
  baseUrl: string,
  token: string | undefined,
  makeSocket: SocketFactory,
  listener: BidiListener<O>,
): BidiCall<I> {
  // The token is sent as a WebSocket subprotocol, because browsers let a page set no other header
  // of a WebSocket.
  const protocols = token === undefined ? [PROTOCOL] : [PROTOCOL, TOKEN_PREFIX + base64Url(token)];
  const socket = makeSocket(addressOf(method, baseUrl), protocols);
  socket.binaryType = "arraybuffer";
  let ended = false;
  const end = (how: CallEnd) => {
    if (ended) return;
    ended = true;
    listener.ended(how);
  };
  socket.onopen = () => {
    if (!ended) listener.opened();
  };
  socket.onclose = ({ code, reason }) => end({ kind: "broken", message: whyClosed(code, reason) });
  socket.onmessage = ({ data }) => {
    if (ended || !(data instanceof ArrayBuffer) || data.byteLength === 0) return;
    const bytes = new Uint8Array(data);
    const body = bytes.subarray(1);
    if (bytes[0] === MESSAGE) {
      const message = parsed(method.output, body);
      if (message !== undefined) listener.message(message);
      else {
        end({ kind: "broken", message: "The server's message cannot be read; reload the page" });
        socket.close(NORMAL_CLOSURE);
      }
    }
    if (bytes[0] === TRAILERS) end(statusOf(body));
  };
  return {
    send: (message) => {
      if (ended || socket.readyState !== OPEN) return;
      socket.send(framed(MESSAGE, toBinary(method.input, create(method.input, message))));
    },
    cancel: () => {
      if (!ended && socket.readyState === OPEN) socket.send(framed(HALF_CLOSE, new Uint8Array()));
      ended = true;
      socket.close(NORMAL_CLOSURE);
    },
  };
}

function parsed<O extends DescMessage>(type: O, body: Uint8Array): MessageShape<O> | undefined {
  try {
    return fromBinary(type, body);
  } catch {
    return undefined;
  }
}

function addressOf(method: BidiMethod<DescMessage, DescMessage>, baseUrl: string): string {
  const url = new URL(`${method.parent.typeName}/${method.name}`, baseUrl);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  return url.href;
}

function framed(kind: number, body: Uint8Array): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(1 + body.byteLength);
  bytes[0] = kind;
  bytes.set(body, 1);
  return bytes;
}

function statusOf(trailers: Uint8Array): CallEnd {
  const values = new Map<string, string>();
  for (const line of new TextDecoder().decode(trailers).split("\r\n")) {
    const colon = line.indexOf(":");
    if (colon > 0)
      values.set(line.slice(0, colon).trim().toLowerCase(), line.slice(colon + 1).trim());
  }
  const code = Number(values.get("grpc-status") ?? Code.Unknown);
  return {
    kind: "status",
    code,
    message: percentDecoded(values.get("grpc-message") ?? ""),
    retryAfterMs: retryAfterMsOfTrailer(values.get("grpc-status-details-bin")),
  };
}

function base64Url(text: string): string {
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

function percentDecoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

function whyClosed(code: number, reason: string): string {
  if (code === GOING_AWAY) return "The server is stopping";
  if (reason !== "") return `The server closed the connection: ${reason}`;
  return "The server cannot be reached";
}
