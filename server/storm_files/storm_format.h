// A format of storm files: how a file of it is recognised, described and read. Which formats there
// are stands in built_in_formats.cc and nowhere else.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {

// A file of unknown format, opened once for all formats to look at.
struct UnknownFile {
  std::string path;
  absl::StatusOr<netcdf::NetcdfFile> netcdf;  // the error says why it cannot be opened as netCDF
};

// How closely a file fits a format. The closest fit wins: a model's own layout before a convention
// that the model's files may happen to follow as well.
enum class FormatFit {
  kNone,
  kConvention,   // follows a convention shared by many programs
  kModelLayout,  // has the layout of one model's files
};

// Has no state: one instance serves all files and threads.
class StormFormat {
 public:
  virtual ~StormFormat() = default;

  // For messages: "WRF output".
  virtual std::string_view Name() const = 0;

  // For messages: the files to give, e.g. "wrfout_...".
  virtual std::string_view Example() const = 0;

  // For messages: the name with what a file that does not fit lacks, e.g. "WRF output (it has no
  // dimension bottom_top)".
  virtual std::string_view Requirement() const = 0;

  // A quick look: reads no fields, and never fails.
  virtual FormatFit Sniff(const UnknownFile& file) const = 0;

  // Reads and checks the metadata of a file that this format fits, and gives it its reader. Errors
  // name the file, the variable and what it lacks.
  virtual absl::StatusOr<StormFile> Describe(const UnknownFile& file) const = 0;
};

// The formats that a store of storms reads. A plain value: to add a format to a copy changes no
// other.
class StormFormats {
 public:
  // All formats of this build.
  static StormFormats BuiltIn();

  void Add(std::shared_ptr<const StormFormat> format) { formats_.push_back(std::move(format)); }

  // Has another process describe every file, and read it by the reader that it gives it.
  using Elsewhere = std::function<absl::StatusOr<StormFile>(const std::string& path)>;
  void LeaveTo(Elsewhere elsewhere) { elsewhere_ = std::move(elsewhere); }

  // Describes the file at `path` by the format that fits it best. Two that fit equally well, or
  // none, are an error.
  absl::StatusOr<StormFile> Describe(const std::string& path) const;

  // The formats' examples for a message: "wrfout_..., or CF netCDF".
  std::string Examples() const;

 private:
  absl::Status NoneFits(const UnknownFile& file) const;

  std::vector<std::shared_ptr<const StormFormat>> formats_;
  Elsewhere elsewhere_;
};

}  // namespace thunderhead::storm_files
