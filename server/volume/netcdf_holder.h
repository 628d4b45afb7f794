// Which file netCDF-C works on now, and since when: behind it every other read waits, so a storage
// that hangs is known by it. Safe from any thread.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "base/time_source.h"

namespace thunderhead::volume {

struct NetcdfHolder {
  std::string path;
  std::chrono::steady_clock::time_point since;

  // None if netCDF-C is not working.
  static std::optional<NetcdfHolder> Now();

  // Measures `since` by that time from now on, in the whole process; it must outlive its use.
  static void MeasureBy(const base::TimeSource& time);

 private:
  friend class NetcdfLock;
  static void Begins(const std::string& path);
  static void Ends();
};

}  // namespace thunderhead::volume
