// Fuzzes volumes that come from a reader of OpenVDB files, which a hostile file may have taken
// over. The program turns them into clouds outside of the confinement.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "interchange/vdb_import.h"
#include "interchange/vdb_volume.h"
#include "sandbox/archive.h"
#include "tests/fuzz/must.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thunderhead;
  using fuzz::Must;
  constexpr std::size_t kPipeHolds = 60'000;
  constexpr std::uint64_t kAllowance = 1 << 20;
  if (size == 0 || size > kPipeHolds) return 0;
  int ends[2];
  Must(pipe(ends) == 0);
  Must(write(ends[1], data + 1, size - 1) == static_cast<ssize_t>(size - 1));
  close(ends[1]);
  interchange::VdbVolume volume;
  sandbox::Receiver reply(ends[0], std::chrono::minutes(10), kAllowance);
  Visit(reply, volume);
  close(ends[0]);
  if (!reply.Ok() || !CheckPlausible(volume).ok()) return 0;
  interchange::ImportOptions options;
  options.up = static_cast<interchange::UpAxis>(data[0] % 3);
  if (data[0] / 3 % 2 == 0) options.base_m = 0.0;
  const auto cloud = CloudOf(volume, options);
  if (!cloud.ok()) return 0;
  Must(cloud->values.size() == cloud->grid.CellCount());
  for (int axis = 0; axis < 3; ++axis) {
    Must(cloud->grid.spacing_m[axis] > 0.0 && std::isfinite(cloud->grid.HighCorner_m()[axis]));
  }
  double sum = 0.0;
  double sum_of_file = 0.0;
  for (const float value : cloud->values) {
    Must(value >= 0.0F && std::isfinite(value));
    sum += value;
  }
  for (const float value : volume.values) sum_of_file += value;
  Must(std::abs(sum - sum_of_file) <= 1e-6 * sum_of_file);
  return 0;
}
