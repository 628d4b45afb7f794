// The confined process of a program that reads one untrusted file and nothing else. The server
// starts it (started_reader.h) with two open descriptors: the file, and memory for large arrays.
// The process receives requests on its standard input, one after another, and sends its replies to
// its standard output.
#pragma once

#include <unistd.h>

#include <memory>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "sandbox/archive.h"
#include "sandbox/file_bundle.h"
#include "sandbox/messages.h"

namespace thunderhead::sandbox {

// The first argument of every reader program.
inline constexpr char kReaderName[] = "thunderhead-reader";

inline constexpr int kFileDescriptor = 3;
inline constexpr int kSharedDescriptor = 4;

// Sends replies to the server.
class Replies {
 public:
  // Large arrays are placed in `shared`. From now on, the process keeps the lines of its log until
  // the next reply, because it has no log file.
  explicit Replies(std::span<std::byte> shared);

  // Sends the lines of the log, and then the reply.
  template <typename Value>
  void Send(Reply reply, Value& value) {
    // Each answer starts a new Sender, so that its arrays start at the first place.
    Sender server(STDOUT_FILENO, shared_);
    for (Note& note : TakeLog()) {
      server(Reply::kLog);
      Visit(server, note);
    }
    server(reply);
    Visit(server, value);
  }
  void SendError(const absl::Status& error);
  // Sends the share of the work that is done, 0 to 1. For each request, the server accepts fewer
  // than 10 000 messages of progress and log together.
  static void SendProgress(double share);

 private:
  class KeptLog;
  std::vector<Note> TakeLog();

  const std::span<std::byte> shared_;
  std::shared_ptr<KeptLog> log_;
};

// A reader program's work on its file.
class FileReader {
 public:
  virtual ~FileReader() = default;

  // Receives the mapped file, or the files of a bundle, before the process is confined. Loads the
  // files that its libraries need. Must not parse the mapped files yet.
  virtual absl::Status Prepare(const std::vector<BundledFile>& files) = 0;

  // Answers a request about the mapped files by exactly one reply, or returns an error.
  virtual absl::Status Answer(const Request& request, Replies& replies) = 0;
};

// Receives a request, maps the file, confines the process and answers requests until the server
// closes the pipe or a request fails. Returns the exit status. The caller must end the process by
// _exit, because a hostile file may have overwritten objects whose destructors would then run.
int RunReader(FileReader& reader);

}  // namespace thunderhead::sandbox
