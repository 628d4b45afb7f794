#include "clouds/cloud_file.h"

#include "absl/strings/match.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "base/version.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_writer.h"

namespace thunderhead::clouds {
namespace {

constexpr const char* kMaker = "thunderhead ";
constexpr const char* kCommand = " generate";

std::string Parameters(const CloudShape& shape, const CloudOrigin& origin) {
  constexpr const char* kInterpolations[] = {"linear", "cosine", "cubic"};
  return absl::StrFormat(
      "preset %s, seed %d, %d octaves, persistence %g, %s interpolation, feature size %g m, "
      "threshold %g, dynamics %g, liquid water %g g/m3, %d ellipsoids",
      origin.preset, origin.seed, shape.noise.octaves, shape.noise.persistence,
      kInterpolations[static_cast<int>(shape.noise.interpolation)], shape.feature_m,
      shape.threshold, shape.dynamics, 1e3 * shape.water_kg_per_m3, shape.ellipsoids.size());
}

}  // namespace

absl::Status WriteGenerated(const CloudShape& shape, const CloudOrigin& origin,
                            const std::string& path, const GenerateObserver& observer,
                            const std::stop_token& stop) {
  storm_files::CfCloud cloud;
  cloud.grid = shape.grid;
  cloud.title = absl::StrFormat("%s, seed %d", origin.preset, origin.seed);
  cloud.source = kMaker + base::Version() + kCommand;
  cloud.comment = Parameters(shape, origin);
  THUNDERHEAD_ASSIGN_OR_RETURN(cloud.values, Generate(shape, observer, stop));
  return storm_files::WriteCfCloud(cloud, path);
}

bool IsGenerated(const std::string& path) {
  const auto file = netcdf::NetcdfFile::Open(path);
  if (!file.ok()) return false;
  const std::string source = file->TextAttribute("", "source").value_or("");
  return absl::StartsWith(source, kMaker) && absl::EndsWith(source, kCommand);
}

}  // namespace thunderhead::clouds
