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
#include <optional>
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
#include "streams/sha256_digest.h"

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;
using FileOr = absl::StatusOr<std::shared_ptr<const OpenFile>>;

constexpr size_t kFilePart = 64 << 10;
// The number of bytes whose digest one call of a file thread computes. Each call has the timeout of
// FileThreads.
constexpr std::uint64_t kCheckedAtOnce = 4 << 20;

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

absl::Status Altered(const std::string& what) {
  return absl::DataLossError(absl::StrCat("it was altered or damaged: ", what));
}

// Compares the digest of a file's bytes with the digest that it must have.
absl::Status CheckDigest(streams::Sha256Digest& digest, const FileContents& wanted) {
  const std::string found = digest.Hexadecimal();
  if (found == wanted.sha256) return absl::OkStatus();
  return Altered(absl::StrCat("its SHA-256 is ", found, " and must be ", wanted.sha256));
}

// Opens a file, and compares its size with the size that it must have.
FileOr OpenKept(const KeptFile& file, const OpenFile::Opener& open,
                std::weak_ptr<FileCloser> closer) {
  FileOr opened = OpenFile::Open(file.path, std::move(closer), open);
  if (!opened.ok() || !file.contents.has_value()) return opened;
  if ((*opened)->Bytes() == file.contents->bytes) return opened;
  return Altered(
      absl::StrCat("it has ", (*opened)->Bytes(), " bytes and must have ", file.contents->bytes));
}

// Reads a file from its beginning, and adds its bytes to a digest. File threads share it, because a
// read may hang.
struct Checking {
  std::shared_ptr<const OpenFile> file;
  streams::Sha256Digest digest;
  std::uint64_t read = 0;
  absl::Status status;

  void ReadOn() {
    std::vector<char> into(kFilePart);
    const std::uint64_t until = std::min(file->Bytes(), read + kCheckedAtOnce);
    while (read < until) {
      const std::ptrdiff_t bytes =
          file->Read(read, into.data(), std::min<std::uint64_t>(kFilePart, until - read));
      if (bytes < 0) status = absl::UnavailableError(strerror(errno));
      if (bytes == 0) status = Altered("it has become shorter");
      if (bytes <= 0) return;
      digest.Add({into.data(), static_cast<size_t>(bytes)});
      read += static_cast<std::uint64_t>(bytes);
    }
  }
};

}  // namespace

// The part of a file that is to be sent.
struct FileAnswers::FilePart {
  FileThreads& threads;
  std::string path;
  std::shared_ptr<const OpenFile> file;
  std::uint64_t first = 0;
  std::uint64_t bytes = 0;
  std::optional<FileContents> contents = std::nullopt;  // checked if the part is the whole file
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
      [found, files = site_.files, path, open_file = site_.options.open_file,
       closer = std::weak_ptr(site_.file_closer),
       accepted = std::string(View(request[http::field::accept_encoding])),
       known = std::string(View(request[http::field::if_none_match])), is_read] {
        found->about = files->Find(path, accepted);
        if (!found->about.has_value() || !is_read) return;
        if (MatchesEntityTag(known, found->about->entity_tag)) return;
        found->file = OpenFile::Open(found->about->path, closer, open_file);
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
  std::function<void()> open = [opened, file, open_file = site_.options.open_file,
                                closer = std::weak_ptr(site_.file_closer)] {
    *opened = OpenKept(file, open_file, closer);
  };
  const std::string owner = FilesOwnerOf(request);
  absl::Status done = co_await site_.kept_threads.Run(executor_, owner, std::move(open));
  if (done.ok()) done = opened->status();
  if (done.ok()) {
    std::shared_ptr<const OpenFile> checked = **opened;
    done = co_await CheckContents(request, file, std::move(checked));
  }
  if (!done.ok()) {
    keep = co_await SendKeptFails(request, file.path, done);
    co_return keep;
  }
  std::shared_ptr<const OpenFile> result = **opened;
  keep = co_await SendKeptPart(request, file, std::move(result));
  co_return keep;
}

net::awaitable<absl::Status> FileAnswers::CheckContents(const Request& request,
                                                        const KeptFile& file,
                                                        std::shared_ptr<const OpenFile> opened) {
  if (!file.contents.has_value() || opened->Bytes() > KeptFile::kCheckedFirst_bytes) {
    co_return absl::OkStatus();
  }
  const auto checking = std::make_shared<Checking>();
  checking->file = std::move(opened);
  const std::string owner = FilesOwnerOf(request);
  while (checking->status.ok() && checking->read < checking->file->Bytes()) {
    std::function<void()> read_on = [checking] { checking->ReadOn(); };
    const absl::Status done = co_await site_.kept_threads.Run(executor_, owner, std::move(read_on));
    if (!done.ok()) co_return done;
  }
  if (!checking->status.ok()) co_return checking->status;
  co_return CheckDigest(checking->digest, *file.contents);
}

net::awaitable<bool> FileAnswers::SendKeptFails(const Request& request, const std::string& path,
                                                const absl::Status& why) {
  bool keep = false;
  if (absl::IsNotFound(why)) {
    keep = co_await answers_.SendText(request, http::status::not_found,
                                      "This file no longer exists.\n");
    co_return keep;
  }
  LogFailedRead(path, why);
  if (absl::IsDataLoss(why)) {
    keep = co_await answers_.SendText(
        request, http::status::internal_server_error,
        "This result was altered or damaged after it was written, so it is not sent; request the "
        "picture in a new job.\n");
    co_return keep;
  }
  keep = co_await SendStorageFails(request);
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
  if (range.bytes == file_bytes) part.contents = file.contents;
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
    absl::Status status;
    streams::Sha256Digest digest;  // digest of all bytes that were read
  };
  const auto read = std::make_shared<Read>();
  const std::string owner = FilesOwnerOf(request);
  do {
    if (part.bytes > 0) {
      const auto most = static_cast<size_t>(std::min<std::uint64_t>(part.bytes, kFilePart));
      std::function<void()> work = [read, file = part.file, first = part.first, most,
                                    is_checked = part.contents.has_value()] {
        read->bytes = file->Read(first, read->into.data(), most);
        if (read->bytes < 0) read->status = absl::UnavailableError(strerror(errno));
        if (read->bytes == 0) read->status = absl::UnavailableError("it has become shorter");
        if (read->bytes > 0 && is_checked)
          read->digest.Add({read->into.data(), static_cast<size_t>(read->bytes)});
      };
      absl::Status done = co_await part.threads.Run(executor_, owner, std::move(work));
      if (done.ok()) done = read->status;
      const bool is_last = done.ok() && static_cast<std::uint64_t>(read->bytes) == part.bytes;
      if (is_last && part.contents.has_value()) done = CheckDigest(read->digest, *part.contents);
      if (!done.ok()) {
        const bool keep_refused = co_await EndFailedPart(request, part.path, done, unsent_header);
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

net::awaitable<bool> FileAnswers::EndFailedPart(const Request& request, const std::string& path,
                                                const absl::Status& why,
                                                const std::string& unsent_header) {
  // After the beginning of a response, only the end of the connection shows the client a failure.
  if (unsent_header.empty()) {
    LogFailedRead(path, why);
    co_return false;
  }
  const bool keep = co_await SendKeptFails(request, path, why);
  sent_whole_ = false;
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
