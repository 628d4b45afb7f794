// Status codes of calls that the network cut. Some server failures have the same codes.
import { Code } from "@connectrpc/connect";

export const NETWORK_CODES: ReadonlySet<Code> = new Set([
  Code.Unknown,
  Code.Unavailable,
  Code.Canceled,
  Code.DeadlineExceeded,
  Code.Internal,
]);
