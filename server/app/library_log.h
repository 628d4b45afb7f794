// What gRPC and protobuf log by themselves goes to the log, as any other line, and no more than
// some lines a second: a client's bytes cause them.
#pragma once

namespace thunderhead::app {

// Before the first use of gRPC.
void TakeLibraryLogs();

}  // namespace thunderhead::app
