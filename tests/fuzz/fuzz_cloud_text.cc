// Fuzzes the cloud fields of radiative transfer programs through everything that a reader does with
// them.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "base/byte_source.h"
#include "storm_files/at3d_format.h"
#include "storm_files/mystic_format.h"
#include "storm_files/shdom_format.h"

namespace thunderhead::storm_files {
namespace {

// A short text may have a grid of many cells, and reading it takes a second. Such grids are left to
// the unit tests.
constexpr std::int64_t kMostCells = 10'000;

void Read(const StormFormat& format, const UnknownFile& unknown) {
  if (format.Sniff(unknown) == FormatFit::kNone) return;
  const auto file = format.Describe(unknown);
  if (!file.ok()) return;
  if (file->fields.empty() || file->times.size() != 1 || file->assumptions.empty()) std::abort();
  if (std::int64_t{file->cells.x} * file->cells.y > kMostCells / file->cells.z) return;
  const auto fields = file->reader->Read(0, std::nullopt, {});
  if (fields.ok() && fields->fields.size() != file->fields.size()) std::abort();
}

}  // namespace
}  // namespace thunderhead::storm_files

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thunderhead;
  const std::string path = "fuzzed";
  base::ReadFromMemory(path, std::as_bytes(std::span(data, size)));
  const storm_files::UnknownFile file(path);
  for (const auto& format : {storm_files::MakeShdomFormat(), storm_files::MakeMysticFormat(),
                             storm_files::MakeAt3dFormat()}) {
    storm_files::Read(*format, file);
  }
  return 0;
}
