// Reads the details of the server's errors: the delay before a retry, and the reason in a form for
// programs.
import { fromBinary } from "@bufbuild/protobuf";
import { anyUnpack, type Duration } from "@bufbuild/protobuf/wkt";
import type { ConnectError } from "@connectrpc/connect";
import { ErrorInfoSchema, RetryInfoSchema } from "../gen/google/rpc/error_details_pb";
import { type Status, StatusSchema } from "../gen/google/rpc/status_pb";

// Returns the delay before a retry that the server asks for; 0 if it asks for none.
export function retryAfterMs(failure: ConnectError): number {
  return milliseconds(failure.findDetails(RetryInfoSchema)[0]?.retryDelay);
}

export function retryAfterMsOfStatus(status: Status | undefined): number {
  for (const detail of status?.details ?? []) {
    const retry = anyUnpack(detail, RetryInfoSchema);
    if (retry !== undefined) return milliseconds(retry.retryDelay);
  }
  return 0;
}

// Returns the error's reason in a form for programs; empty if the server gives no reason.
export function reasonOfStatus(status: Status | undefined): string {
  for (const detail of status?.details ?? []) {
    const info = anyUnpack(detail, ErrorInfoSchema);
    if (info !== undefined) return info.reason;
  }
  return "";
}

// Reads the delay from the trailer grpc-status-details-bin.
export function retryAfterMsOfTrailer(base64: string | undefined): number {
  if (base64 === undefined) return 0;
  try {
    const bytes = Uint8Array.from(atob(base64), (char) => char.charCodeAt(0));
    return retryAfterMsOfStatus(fromBinary(StatusSchema, bytes));
  } catch {
    return 0;
  }
}

function milliseconds(delay: Duration | undefined): number {
  return delay === undefined ? 0 : Number(delay.seconds) * 1000 + delay.nanos / 1e6;
}
