// How calls end that the network cut; some failures of servers have the same codes.
import { Code } from "@connectrpc/connect";

export const NETWORK_CODES: ReadonlySet<Code> = new Set([
  Code.Unknown,
  Code.Unavailable,
  Code.Canceled,
  Code.DeadlineExceeded,
  Code.Internal,
]);
