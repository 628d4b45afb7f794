// Reads coastlines and borders of the whole Earth from the data package GSHHG, in the binned netCDF
// files that GMT reads (Wessel and Smith 1996, J. Geophys. Res. 101, 8741-8743). Debian's packages
// are gmt-gshhg-low and gmt-gshhg-high. The files are read only for storms whose place on Earth is
// known. This code is safe to call from any thread.
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

// The folder in which Debian's packages install the files.
inline constexpr char kBorderFolder[] = "/usr/share/gmt-gshhg";

// Returns the texel grid on which lines are drawn. It covers the columns of `grid` and their
// surroundings.
volume::BorderGrid BorderGridOf(const volume::RegularGrid& grid);

class BorderData {
 public:
  // Returns the data in `folder`, or null if the folder contains no border data.
  static std::shared_ptr<BorderData> Find(const std::string& folder);

  // Returns the map of lines around a storm's grid at a time of the storm. The lines are from the
  // coarsest data set that is as fine as the map's texels, or from the finest if none is. If an
  // equal map is still in use, returns this map. Returns null for a storm without a map projection.
  // If the data cannot be read, returns null and logs the error.
  std::shared_ptr<const volume::BorderMap> MapOf(const StormInfo& storm, std::size_t time_index,
                                                 const volume::RegularGrid& grid);

  // Returns the coastlines and borders in the area of `grid` and near it, in world metres. Small
  // islands and lakes are left out. Returns an error if a data file cannot be read.
  absl::StatusOr<std::vector<volume::BorderLine>> LinesOf(const volume::MapProjection& projection,
                                                          const volume::BorderGrid& grid) const;

 private:
  // Identifies a map: the map projection, its middle, and the grid's low corner and size.
  using Key = std::tuple<std::string, double, double, double, double, double, double>;

  BorderData(std::string folder, std::string details)
      : folder_(std::move(folder)), details_(std::move(details)) {}

  const std::string folder_;
  const std::string details_;  // letters of the data sets in the folder, the finest first
  std::mutex mutex_;           // held while a map is made
  std::map<Key, std::weak_ptr<const volume::BorderMap>> maps_;
};

}  // namespace thunderhead::storm_store
