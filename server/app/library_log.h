// Sends the lines that gRPC and protobuf write by themselves to the log, at most a few a second: a
// client's bytes cause them.
#pragma once

namespace thunderhead::app {

// Before the first use of gRPC.
void TakeLibraryLogs();

}  // namespace thunderhead::app
