// The interface of a storm file format: how a file is recognised, described and read.
// built_in_formats.cc lists all formats.
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

// A file whose format is not known yet. It is opened once, and all formats examine the open file.
struct UnknownFile {
  std::string path;
  absl::StatusOr<netcdf::NetcdfFile> netcdf;  // the open file, or the error why it cannot be opened
                                              // as netCDF
};

// How closely a file fits a format. The format with the closest fit is used. A model's own layout
// wins over a convention, because the model's files may also follow the convention.
enum class FormatFit {
  kNone,
  kConvention,   // the file follows a convention that many programs share
  kModelLayout,  // the file has the layout of one model's files
};

// A format has no state: one instance serves all files and threads.
class StormFormat {
 public:
  virtual ~StormFormat() = default;

  // Returns the name for messages: "WRF output".
  virtual std::string_view Name() const = 0;

  // Returns an example of a file for messages, e.g. "wrfout_...".
  virtual std::string_view Example() const = 0;

  // Returns the name with a requirement that a file without this format does not meet, for
  // messages. An example is "WRF output (it has no dimension bottom_top)".
  virtual std::string_view Requirement() const = 0;

  // Checks the file quickly. Reads no fields and never fails.
  virtual FormatFit Sniff(const UnknownFile& file) const = 0;

  // Reads and checks the metadata of a file that fits this format, and sets its reader. Errors name
  // the file, the variable and what it lacks.
  virtual absl::StatusOr<StormFile> Describe(const UnknownFile& file) const = 0;
};

// The formats that a store of storms reads. This is a plain value, so adding a format to a copy
// changes no other copy.
class StormFormats {
 public:
  // Returns all formats of this build.
  static StormFormats BuiltIn();

  void Add(std::shared_ptr<const StormFormat> format) { formats_.push_back(std::move(format)); }

  // Makes `elsewhere` describe every file, for example in another process. Each file is then read
  // by the reader in its description.
  using Elsewhere = std::function<absl::StatusOr<StormFile>(const std::string& path)>;
  void LeaveTo(Elsewhere elsewhere) { elsewhere_ = std::move(elsewhere); }

  // Describes the file at `path` by the format that fits it best. It is an error if no format fits,
  // or if two fit equally well.
  absl::StatusOr<StormFile> Describe(const std::string& path) const;

  // Returns the formats' examples for a message: "wrfout_..., or CF netCDF".
  std::string Examples() const;

 private:
  absl::Status NoneFits(const UnknownFile& file) const;

  std::vector<std::shared_ptr<const StormFormat>> formats_;
  Elsewhere elsewhere_;
};

}  // namespace thunderhead::storm_files
