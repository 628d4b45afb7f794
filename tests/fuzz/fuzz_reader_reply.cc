// Fuzzes replies of a reader process that a hostile file has taken over. Replies that the server
// accepts must not harm the rooms that use them.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "sandbox/archive.h"
#include "sandbox/messages.h"
#include "sandbox/plausible.h"
#include "volume/extinction.h"

namespace thunderhead::sandbox {
namespace {

constexpr std::uint64_t kAllowance = 1 << 20;

// Reads the fields' arrays, which must be consistent with each other.
void ReadArrays(const volume::HydrometeorFields& fields) {
  const std::size_t cells = fields.grid.CellCount();
  for (const volume::HydrometeorField& field : fields.fields) {
    if (field.concentration_kg_per_m3.empty()) continue;
    std::vector<float> sums(cells, 0.0F);
    for (const bool by_cell : {false, true}) {
      if (by_cell && field.sizes.Empty()) continue;
      volume::AddExtinction(field, {.m2_per_kg = 1.0F, .by_cell = by_cell}, 0, cells, sums.data());
    }
  }
  for (const float height_m : fields.terrain_height_m) {
    if (!std::isfinite(height_m)) std::abort();
  }
  if (!fields.land.Empty()) volume::LandAt(fields.land, fields.grid, {0.0, 0.0});
}

}  // namespace
}  // namespace thunderhead::sandbox

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thunderhead;
  using namespace thunderhead::sandbox;
  constexpr std::size_t kPipeHolds = 60'000;
  if (size == 0 || size > kPipeHolds) return 0;
  int ends[2];
  if (pipe(ends) != 0) std::abort();
  if (write(ends[1], data + 1, size - 1) != static_cast<ssize_t>(size - 1)) std::abort();
  close(ends[1]);
  Receiver reply(ends[0], std::chrono::minutes(10), kAllowance);
  if (data[0] % 2 == 0) {
    storm_files::StormFile file;
    Visit(reply, file);
    if (reply.Ok()) static_cast<void>(CheckPlausible(file));
  } else {
    storm_files::StormFile file;
    volume::HydrometeorFields fields;
    Visit(reply, fields);
    file.cells = fields.grid.cells;
    if (reply.Ok() && CheckPlausible(fields, glm::ivec2(file.cells)).ok()) ReadArrays(fields);
  }
  close(ends[0]);
  return 0;
}
