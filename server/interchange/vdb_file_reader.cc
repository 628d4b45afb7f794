#include "interchange/vdb_file_reader.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/machine_memory.h"
#include "base/program_folder.h"
#include "base/status.h"
#include "interchange/vdb_reader_main.h"
#include "sandbox/readers.h"
#include "storm_files/vdb_start.h"

namespace thunderhead::interchange {
namespace {

absl::Status CheckVdbStart(const std::string& path, int file) {
  std::string start(storm_files::kVdbStart.size(), '\0');
  const ssize_t count = pread(file, start.data(), start.size(), 0);
  if (count == std::ssize(start) && storm_files::BeginsLikeVdb(start)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": does not begin like an OpenVDB file; give a file that is one"));
}

absl::StatusOr<std::string> ProgramOr(const std::string& given) {
  if (!given.empty()) return given;
  const std::filesystem::path path = base::ProgramFolder() / kVdbReaderName;
  std::error_code error;
  if (std::filesystem::exists(path, error)) return path.string();
  return absl::InternalError(absl::StrCat(
      path.string(), ", which reads OpenVDB files, does not exist; install all of Thunderhead"));
}

// Returns the limits of the reader of the file at `path`.
sandbox::ReaderLimits LimitsFor(const std::string& path, const VdbReaderOptions& options) {
  sandbox::ReaderLimits limits;
  limits.memory_flag = options.memory_flag;
  limits.stop = options.stop;
  limits.memory_bytes = options.memory_bytes;
  if (limits.memory_bytes > 0) return limits;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  // If the size is unknown, the limit does not matter, because such a file cannot be opened either.
  limits.memory_bytes = DefaultVdbMemory_bytes(error ? 0 : size);
  return limits;
}

}  // namespace

std::uint64_t DefaultVdbMemory_bytes(std::uint64_t file_bytes) {
  constexpr std::uint64_t kLeast_bytes = std::uint64_t{512} << 20;
  constexpr std::uint64_t kPerByte = 100;
  const std::uint64_t machine = base::MachineMemoryBytes();
  const std::uint64_t most = machine > 0 ? machine : std::uint64_t{1} << 46;
  return std::min(most, kLeast_bytes + kPerByte * std::min(file_bytes, most / kPerByte));
}

absl::StatusOr<VdbVolume> ReadVdb(const std::string& path, const std::string& grid,
                                  const storm_files::ReadCheckpoint& checkpoint,
                                  const VdbReaderOptions& options) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string reader, ProgramOr(options.program));
  const sandbox::ReaderLimits limits = LimitsFor(path, options);
  sandbox::Readers readers(limits, base::SteadyTime(), reader, {.start = CheckVdbStart});
  sandbox::Request request;
  request.wanted = sandbox::Wanted::kOther;
  request.path = path;
  request.part = grid;
  VdbVolume volume;
  THUNDERHEAD_RETURN_IF_ERROR(readers.Run(std::move(request), sandbox::Reply::kOther, {limits.time},
                                          checkpoint, [&volume](sandbox::Receiver& from_reader) {
                                            Visit(from_reader, volume);
                                            return CheckPlausible(volume);
                                          }));
  volume.grid = grid;  // replaces the name that the other process sent
  return volume;
}

}  // namespace thunderhead::interchange
