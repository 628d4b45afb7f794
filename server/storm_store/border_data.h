// Coasts and borders of the whole Earth from the data package GSHHG, in the binned netCDF files
// that GMT reads (Wessel and Smith 1996, J. Geophys. Res. 101, 8741-8743; on Debian gmt-gshhg-low
// and gmt-gshhg-high): read for a storm with a place on Earth. Safe to call from any thread.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "storm_store/storm_store.h"
#include "volume/border_map.h"
#include "volume/grid.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_store {

// Where Debian's packages put the files.
inline constexpr char kBorderFolder[] = "/usr/share/gmt-gshhg";

// The part of the world's plane that lines are drawn on around the columns of a grid.
volume::BorderGrid BorderGridOf(const volume::RegularGrid& grid);

class BorderData {
 public:
  // The data in that folder; null if there are none.
  static std::shared_ptr<BorderData> Find(const std::string& folder);

  // The lines around a storm's grid, of the coarsest data that are as fine as the map's texels.
  // Null for a storm without a map projection, and where the data cannot be read, which the log
  // tells. A map that somebody holds is given again.
  std::shared_ptr<const volume::BorderMap> MapOf(const StormInfo& storm,
                                                 const volume::RegularGrid& grid);

  // The lines on that grid.
  absl::StatusOr<std::vector<volume::BorderLine>> LinesOf(const volume::MapProjection& projection,
                                                          const volume::BorderGrid& grid) const;

 private:
  // A map projection, its middle, and the grid's low corner and size.
  using Key = std::tuple<std::string, double, double, double, double, double, double>;

  BorderData(std::string folder, std::string details)
      : folder_(std::move(folder)), details_(std::move(details)) {}

  const std::string folder_;
  const std::string details_;  // letters of those in the folder, the finest first
  std::mutex mutex_;           // held while a map is made
  std::map<Key, std::weak_ptr<const volume::BorderMap>> maps_;
};

}  // namespace thunderhead::storm_store
