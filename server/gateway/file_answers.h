// Responses with files: those of the page, and those that the service keeps. The threads for files
// find, open and read them, because their storage may hang.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "gateway/awaitable.h"
#include "gateway/client_link.h"
#include "gateway/http_answers.h"
#include "gateway/open_file.h"
#include "gateway/site.h"
#include "gateway/static_files.h"

namespace thunderhead::gateway {

// The result of finding a page's file on a thread for files.
struct PageFile {
  std::optional<StaticFile> about;  // empty if there is no file at that path
  absl::StatusOr<std::shared_ptr<const OpenFile>> file = absl::NotFoundError("it was not opened");
};

class FileAnswers {
 public:
  using Request = HttpAnswers::Request;
  template <typename T>
  using Awaitable = HttpAnswers::Awaitable<T>;

  FileAnswers(HttpAnswers& answers, ClientLink& link, Site& site)
      : answers_(answers), link_(link), site_(site), executor_(link.Stream().get_executor()) {}

  // Finds the page's file at that path, and opens it if it must be sent. Returns an error if its
  // storage hangs.
  Awaitable<absl::StatusOr<PageFile>> FindPageFile(const Request& request, const std::string& path);
  // Sends a file. Both functions return true if the connection may be used again.
  Awaitable<bool> SendFile(const Request& request, const PageFile& page);
  Awaitable<bool> SendKept(const Request& request, const KeptFile& file);
  // Sends an error because the file's storage hangs or fails, before any of the file was sent.
  Awaitable<bool> SendStorageFails(const Request& request);

 private:
  struct FilePart;

  Awaitable<bool> SendKeptPart(const Request& request, const KeptFile& file,
                               std::shared_ptr<const OpenFile> opened);
  // Sends `header`, which must contain the part's length, and then the part.
  Awaitable<bool> SendPart(const Request& request, HttpAnswers::Header& header, FilePart part);
  // Returns the client that the work on files counts for. All connections of a client share one
  // quota of the threads for files.
  std::string FilesOwnerOf(const Request& request) const;
  void LogFailedRead(const std::string& path, const absl::Status& why);

  HttpAnswers& answers_;
  ClientLink& link_;
  Site& site_;
  const boost::asio::any_io_executor executor_;
  bool sent_whole_ = false;  // true if the last part was sent completely
};

}  // namespace thunderhead::gateway
