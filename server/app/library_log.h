// Redirects the log lines of gRPC and protobuf to the program's log. They are limited to a few per
// second, because clients can cause them.
#pragma once

namespace thunderhead::app {

// Installs the redirection. It must be called before the first use of gRPC.
void TakeLibraryLogs();

}  // namespace thunderhead::app
