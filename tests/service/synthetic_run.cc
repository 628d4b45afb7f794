#include "tests/service/synthetic_run.h"

#include <chrono>
#include <cmath>
#include <filesystem>

#include "absl/strings/str_format.h"
#include "tests/support/synthetic_wrf.h"

namespace thunderhead::testing {

std::string RunFile(const std::string& folder, int time) {
  return absl::StrFormat("%s/wrfout_d01_2013-05-20_20:%d0:00", folder, time);
}

std::string RunTime(int time) { return absl::StrFormat("20130520_20%d0", time); }

void WriteRunFile(const std::string& folder, int time, double density, bool torn) {
  SyntheticWrf file;
  file.nx = 12;
  file.ny = 12;
  file.levels = 10;
  file.dy_m = 1000.0;
  file.top_m = 8000.0;
  file.times = {absl::StrFormat("2013-05-20_20:%d0:00", time)};
  file.mixing_ratios["QCLOUD"] = [=](const WrfCell& cell) {
    const double x = (cell.x - 5.5 - 0.4 * time) / 3.0;
    const double y = (cell.y - 5.5) / 3.0;
    const double z = (cell.level - 4.5) / 3.0;
    return density * 1e-3 * std::exp(-(x * x + y * y + z * z));
  };
  if (torn) file.unwritten = {"QCLOUD"};
  WriteWrf(file, RunFile(folder, time));
}

void KeepFresh(const std::string& file) {
  std::filesystem::last_write_time(
      file, std::filesystem::file_time_type::clock::now() + std::chrono::minutes(1));
}

void LeaveAlone(const std::string& file) {
  std::filesystem::last_write_time(
      file, std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
}

}  // namespace thunderhead::testing
