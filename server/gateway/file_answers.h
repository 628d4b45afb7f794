// Responses with files: the page's files, and files that the service provides (KeptFile). Separate
// threads find, open and read the files, because their storage may block.
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

// The result of looking for a page's file.
struct PageFile {
  std::optional<StaticFile> about;  // absent if there is no file at that path
  absl::StatusOr<std::shared_ptr<const OpenFile>> file = absl::NotFoundError("it was not opened");
};

class FileAnswers {
 public:
  using Request = HttpAnswers::Request;
  template <typename T>
  using Awaitable = HttpAnswers::Awaitable<T>;

  FileAnswers(HttpAnswers& answers, ClientLink& link, Site& site)
      : answers_(answers), link_(link), site_(site), executor_(link.Stream().get_executor()) {}

  // Looks for the page's file at that path, and opens it if its contents must be sent. Returns an
  // error if the storage does not respond.
  Awaitable<absl::StatusOr<PageFile>> FindPageFile(const Request& request, const std::string& path);
  // Sends a file. Both functions return true if the connection may be used again.
  Awaitable<bool> SendFile(const Request& request, const PageFile& page);
  Awaitable<bool> SendKept(const Request& request, const KeptFile& file);
  // Sends an error because the file's storage blocks or fails. Nothing of the file may have been
  // sent yet.
  Awaitable<bool> SendStorageFails(const Request& request);

 private:
  struct FilePart;

  // Checks the digest of a file if `file.contents` gives one and the file has at most
  // KeptFile::kCheckedFirst_bytes. Returns DATA_LOSS for other contents, UNAVAILABLE for a failed
  // read, and the errors of FileThreads::Run.
  Awaitable<absl::Status> CheckContents(const Request& request, const KeptFile& file,
                                        std::shared_ptr<const OpenFile> opened);
  // Sends an error because a kept file cannot be sent.
  Awaitable<bool> SendKeptFails(const Request& request, const std::string& path,
                                const absl::Status& why);
  Awaitable<bool> SendKeptPart(const Request& request, const KeptFile& file,
                               std::shared_ptr<const OpenFile> opened);
  // Sends `header`, which must contain the part's length, and then the part of the file.
  Awaitable<bool> SendPart(const Request& request, HttpAnswers::Header& header, FilePart part);
  // Ends a response because the rest of its file cannot be read. If `unsent_header` is not empty,
  // nothing was sent yet, and an error is sent. Otherwise returns false, so that the connection is
  // closed.
  Awaitable<bool> EndFailedPart(const Request& request, const std::string& path,
                                const absl::Status& why, const std::string& unsent_header);
  // Returns the name of the client for the threads' quota. All connections of a client share one
  // quota.
  std::string FilesOwnerOf(const Request& request) const;
  void LogFailedRead(const std::string& path, const absl::Status& why);

  HttpAnswers& answers_;
  ClientLink& link_;
  Site& site_;
  const boost::asio::any_io_executor executor_;
  bool sent_whole_ = false;  // true if the last file part was sent completely
};

}  // namespace thunderhead::gateway
