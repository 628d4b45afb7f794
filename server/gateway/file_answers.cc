#include "gateway/file_answers.h"

#include <algorithm>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/write.hpp>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/client_network.h"
#include "gateway/byte_range.h"
#include "gateway/file_threads.h"
#include "gateway/text_view.h"
#include "spdlog/spdlog.h"

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;
using FileOr = absl::StatusOr<std::shared_ptr<const OpenFile>>;

constexpr size_t kFilePart = 64 << 10;

const char* PictureTypeOf(const std::string& path) {
  if (path.ends_with(".png")) return "image/png";
  if (path.ends_with(".jpeg")) return "image/jpeg";
  return "application/octet-stream";
}

void DescribeKept(const std::string& entity_tag, http::fields& header) {
  header.set(http::field::etag, entity_tag);
  header.set(http::field::cache_control, "private, no-cache");
  header.set(http::field::accept_ranges, "bytes");
}

}  // namespace

// The part of a file that is to be sent.
struct FileAnswers::FilePart {
  FileThreads& threads;
  std::string path;
  std::shared_ptr<const OpenFile> file;
  std::uint64_t first = 0;
  std::uint64_t bytes = 0;
};

std::string FileAnswers::FilesOwnerOf(const Request& request) const {
  return base::NetworkOf(answers_.OwnerOf(request));
}

net::awaitable<absl::StatusOr<PageFile>> FileAnswers::FindPageFile(const Request& request,
                                                                   const std::string& path) {
  if (site_.files->IsEmpty()) co_return PageFile();
  const auto found = std::make_shared<PageFile>();
  const bool is_read = request.method() != http::verb::post;
  // The function is stored in a variable because GCC 12 destroys some temporaries of a co_await
  // twice.
  std::function<void()> find =
      [found, files = site_.files, path, closer = std::weak_ptr(site_.file_closer),
       accepted = std::string(View(request[http::field::accept_encoding])),
       known = std::string(View(request[http::field::if_none_match])), is_read] {
        found->about = files->Find(path, accepted);
        if (!found->about.has_value() || !is_read) return;
        if (MatchesEntityTag(known, found->about->entity_tag)) return;
        found->file = OpenFile::Open(found->about->path, closer);
      };
  const std::string owner = FilesOwnerOf(request);
  const absl::Status done = co_await site_.page_threads.Run(executor_, owner, std::move(find));
  if (!done.ok()) co_return done;
  co_return *found;
}

net::awaitable<bool> FileAnswers::SendFile(const Request& request, const PageFile& page) {
  const StaticFile& about = *page.about;
  http::response<http::empty_body> header(http::status::ok, request.version());
  header.set(http::field::etag, about.entity_tag);
  header.set(http::field::cache_control, about.cache_control);
  if (about.varies) header.set(http::field::vary, "Accept-Encoding");
  bool keep = false;
  if (MatchesEntityTag(View(request[http::field::if_none_match]), about.entity_tag)) {
    header.result(http::status::not_modified);
    keep = co_await answers_.Send(request, header);
    co_return keep;
  }
  if (!page.file.ok()) {
    spdlog::warn("{}", std::string(page.file.status().message()));
    keep =
        co_await answers_.SendText(request, http::status::not_found, "This file cannot be read.\n");
    co_return keep;
  }
  const std::shared_ptr<const OpenFile>& file = *page.file;
  header.set(http::field::content_type, about.content_type);
  if (!about.content_encoding.empty()) {
    header.set(http::field::content_encoding, about.content_encoding);
  }
  header.content_length(file->Bytes());
  FilePart all{site_.page_threads, about.path.string(), file, 0, file->Bytes()};
  keep = co_await SendPart(request, header, std::move(all));
  co_return keep;
}

net::awaitable<bool> FileAnswers::SendKept(const Request& request, const KeptFile& file) {
  bool keep = false;
  const std::string entity_tag = absl::StrCat("\"", file.entity_tag, "\"");
  if (MatchesEntityTag(View(request[http::field::if_none_match]), entity_tag)) {
    http::response<http::empty_body> header(http::status::not_modified, request.version());
    DescribeKept(entity_tag, header);
    keep = co_await answers_.Send(request, header);
    co_return keep;
  }
  const auto opened = std::make_shared<FileOr>(absl::NotFoundError("not opened"));
  std::function<void()> open = [opened, path = file.path,
                                closer = std::weak_ptr(site_.file_closer)] {
    *opened = OpenFile::Open(path, closer);
  };
  const std::string owner = FilesOwnerOf(request);
  const absl::Status done = co_await site_.kept_threads.Run(executor_, owner, std::move(open));
  if (!done.ok()) {
    keep = co_await SendStorageFails(request);
  } else if (!opened->ok()) {
    keep = co_await answers_.SendText(request, http::status::not_found,
                                      "This file no longer exists.\n");
  } else {
    std::shared_ptr<const OpenFile> result = **opened;
    keep = co_await SendKeptPart(request, file, std::move(result));
  }
  co_return keep;
}

net::awaitable<bool> FileAnswers::SendKeptPart(const Request& request, const KeptFile& file,
                                               std::shared_ptr<const OpenFile> opened) {
  http::response<http::empty_body> header(http::status::ok, request.version());
  const std::string entity_tag = absl::StrCat("\"", file.entity_tag, "\"");
  DescribeKept(entity_tag, header);
  // The whole file is sent if its contents differ from those of which the client already has a
  // part. Only GET supports parts.
  const std::string_view only_if = View(request[http::field::if_range]);
  const bool may_be_part =
      request.method() == http::verb::get && (only_if.empty() || only_if == entity_tag);
  const ByteRange range =
      RangeOf(may_be_part ? View(request[http::field::range]) : "", opened->Bytes());
  bool keep = false;
  if (range.asked == ByteRange::Asked::kNothingThere) {
    header.result(http::status::range_not_satisfiable);
    header.set(http::field::content_range, absl::StrCat("bytes */", opened->Bytes()));
    header.content_length(0);
    keep = co_await answers_.Send(request, header);
    co_return keep;
  }
  if (range.asked == ByteRange::Asked::kPart) {
    header.result(http::status::partial_content);
    header.set(http::field::content_range,
               absl::StrCat("bytes ", range.first, "-", range.first + range.bytes - 1, "/",
                            opened->Bytes()));
  }
  header.set(http::field::content_type, PictureTypeOf(file.path));
  header.content_length(range.bytes);
  const std::uint64_t file_bytes = opened->Bytes();
  FilePart part{site_.kept_threads, file.path, std::move(opened), range.first, range.bytes};
  keep = co_await SendPart(request, header, std::move(part));
  const bool to_its_end =
      request.method() == http::verb::get && range.first + range.bytes == file_bytes;
  if (sent_whole_ && to_its_end && file.on_sent != nullptr) file.on_sent();
  co_return keep;
}

net::awaitable<bool> FileAnswers::SendPart(const Request& request,
                                           http::response<http::empty_body>& header,
                                           FilePart part) {
  const bool keep = answers_.Complete(request, header);
  const auto end = answers_.EndOfSending(part.bytes);
  std::ostringstream text;
  text << header.base();
  // The header is sent together with the first part of the file.
  std::string unsent_header = text.str();
  if (request.method() == http::verb::head) part.bytes = 0;
  sent_whole_ = false;
  // The reading thread shares ownership of this state, because its read may hang.
  struct Read {
    std::vector<char> into = std::vector<char>(kFilePart);
    std::ptrdiff_t bytes = 0;
    std::string error;
  };
  const auto read = std::make_shared<Read>();
  const std::string owner = FilesOwnerOf(request);
  do {
    if (part.bytes > 0) {
      const auto most = static_cast<size_t>(std::min<std::uint64_t>(part.bytes, kFilePart));
      std::function<void()> work = [read, file = part.file, first = part.first, most] {
        read->bytes = file->Read(first, read->into.data(), most);
        if (read->bytes < 0) read->error = strerror(errno);
        if (read->bytes == 0) read->error = "it has become shorter";
      };
      const absl::Status done = co_await part.threads.Run(executor_, owner, std::move(work));
      if (!done.ok() || read->bytes <= 0) {
        LogFailedRead(part.path, done.ok() ? absl::UnavailableError(read->error) : done);
        if (unsent_header.empty()) co_return false;
        const bool keep_refused = co_await SendStorageFails(request);
        sent_whole_ = false;
        co_return keep_refused;
      }
    }
    const auto bytes = static_cast<size_t>(read->bytes);
    // With TLS, Beast writes the first buffer alone if all buffers together are too long. If the
    // first buffer is empty, nothing is then written. So empty buffers are left out.
    std::vector<net::const_buffer> buffers;
    if (!unsent_header.empty()) buffers.push_back(net::buffer(unsent_header));
    buffers.push_back(net::buffer(read->into.data(), bytes));
    const bool written = co_await link_.WriteAll(std::move(buffers), end);
    if (!written) co_return false;
    unsent_header.clear();
    part.first += bytes;
    part.bytes -= bytes;
  } while (part.bytes > 0);
  sent_whole_ = true;
  co_return keep;
}

net::awaitable<bool> FileAnswers::SendStorageFails(const Request& request) {
  const bool keep =
      co_await answers_.SendText(request, http::status::service_unavailable,
                                 "The storage of this file does not answer; try again later.\n");
  co_return keep;
}

void FileAnswers::LogFailedRead(const std::string& path, const absl::Status& why) {
  if (absl::IsCancelled(why)) return;
  const auto left_out = site_.failed_reads.Take(std::chrono::system_clock::now());
  if (!left_out.has_value()) return;
  spdlog::warn("cannot read {}: {} ({} more since the last line)", path, std::string(why.message()),
               *left_out);
}

}  // namespace thunderhead::gateway
