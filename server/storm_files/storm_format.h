// The interface of a storm file format: how a file is recognised, described and read.
// built_in_formats.cc lists all formats.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "base/byte_source.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {

// The longest time that the description of one file or of one batch may take. A description reads
// no fields, and the catalogue waits for it.
inline constexpr std::chrono::milliseconds kLongestDescription{60'000};

// A file whose format is not known yet. It is opened once, and all formats examine its bytes.
class UnknownFile {
 public:
  explicit UnknownFile(const std::string& path);

  const std::string& Path() const { return path_; }

  // Returns the file's bytes, or the error why they cannot be read.
  const absl::StatusOr<std::shared_ptr<const base::ByteSource>>& Bytes() const { return bytes_; }

  // Returns the first kStart_bytes bytes. They are fewer if the file is shorter, and none if it
  // cannot be read.
  std::string_view Start() const { return start_; }

  // Returns the file opened as netCDF, or the error why it cannot be opened so. The first call
  // opens it. Not safe from several threads.
  const absl::StatusOr<netcdf::NetcdfFile>& Netcdf() const;

  static constexpr std::size_t kStart_bytes = 4096;

 private:
  const std::string path_;
  const absl::StatusOr<std::shared_ptr<const base::ByteSource>> bytes_;
  std::string start_;
  mutable std::optional<absl::StatusOr<netcdf::NetcdfFile>> netcdf_;
};

// How closely a file fits a format. The format with the closest fit is used. A model's own layout
// wins over a convention, because the model's files may also follow the convention.
enum class FormatFit {
  kNone,
  // The file resembles the format but lacks something that it needs. Describe returns the reason.
  kRelated,
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

  // Returns whether a file that begins with these bytes may have this format. A file that no format
  // may read is refused before a process is started for it. By default returns false.
  // StormFormats::CheckStart also accepts a netCDF file for which all formats return false.
  virtual bool MayBegin(std::string_view start) const;

  // Checks a file of `size_bytes` bytes, which begins with `start`, against other files of its
  // folder. Returns an error if they show that it is not whole. It is called in a process that may
  // open files.
  virtual absl::Status CheckNeighbours(const std::string& /*path*/, std::string_view /*start*/,
                                       std::uint64_t /*size_bytes*/) const {
    return absl::OkStatus();
  }

  // Loads the files that the format's libraries need, for a process that then may open no file.
  virtual absl::Status PrepareBeforeConfinement() const { return absl::OkStatus(); }

  // Checks the file quickly. Reads no fields and never fails.
  virtual FormatFit Sniff(const UnknownFile& file) const = 0;

  // Reads and checks the metadata of a file that fits this format, and sets its reader. Errors name
  // the file, the variable and what it lacks. If a time is spread over several files, this sets
  // StormFile::part, member, times and about, and nothing else is needed. If the file has several
  // storms, this sets StormFile::others.
  virtual absl::StatusOr<StormFile> Describe(const UnknownFile& file) const = 0;

  // Describes the files of one time, which have this format and an equal StormPart::of, and sets
  // the reader. Errors name what is missing. Only formats that set StormFile::part implement it.
  virtual absl::StatusOr<StormFile> DescribeTogether(const std::vector<UnknownFile>& files) const;
};

// The formats that a store of storms reads. This is a plain value, so adding a format to a copy
// changes no other copy.
class StormFormats {
 public:
  // Returns all formats of this build.
  static StormFormats BuiltIn();

  void Add(std::shared_ptr<const StormFormat> format) { formats_.push_back(std::move(format)); }

  // Functions that describe files somewhere else, for example in another process. They do what the
  // functions of StormFormats with the same names do. Each file is then read by the reader in its
  // description. `describe_each` may be empty. `describe_together` may be empty if no format
  // spreads a time over several files.
  struct Elsewhere {
    std::function<absl::StatusOr<StormFile>(const std::string& path)> describe;
    std::function<std::vector<absl::StatusOr<StormFile>>(const std::vector<std::string>& paths,
                                                         std::chrono::milliseconds patience)>
        describe_each = {};
    std::function<absl::StatusOr<StormFile>(const std::vector<std::string>& paths)>
        describe_together = {};
  };
  void LeaveTo(Elsewhere elsewhere) { elsewhere_ = std::move(elsewhere); }

  // Checks an open file before a process is started to read it. Returns an error if it begins like
  // no format's files, or if other files of its folder show that it is not whole. Returns
  // UNAVAILABLE while another program writes it and has locked it.
  absl::Status CheckStart(const std::string& path, int file) const;

  // Prepares each format that may read one of the files, which begin with `starts`
  // (StormFormat::PrepareBeforeConfinement).
  absl::Status PrepareBeforeConfinement(const std::vector<std::string_view>& starts) const;

  // Describes the file at `path` by the format that fits it best. It is an error if no format fits,
  // or if two fit equally well.
  absl::StatusOr<StormFile> Describe(const std::string& path) const;

  // Describes several files, each separately, in the order of `paths`. This is faster than to
  // describe small files one after the other. In another process, the files together may take
  // `patience`, but at most kLongestDescription. If they take longer, each file that is not
  // described gets ABORTED: describe it alone and with more patience. If a single file takes
  // kLongestDescription, the error says that its reader took too long.
  std::vector<absl::StatusOr<StormFile>> DescribeEach(
      const std::vector<std::string>& paths,
      std::chrono::milliseconds patience = kLongestDescription) const;

  // Describes the files of one time that is spread over several files. The description has the
  // first path.
  absl::StatusOr<StormFile> DescribeTogether(const std::vector<std::string>& paths) const;

  // Returns the formats' examples for a message: "wrfout_..., CF netCDF, or GRIB2".
  std::string Examples() const;

 private:
  absl::Status NoneFits(const UnknownFile& file) const;
  // Returns the format that fits the file best.
  absl::StatusOr<const StormFormat*> FormatOf(const UnknownFile& file) const;

  std::vector<std::shared_ptr<const StormFormat>> formats_;
  Elsewhere elsewhere_;
};

}  // namespace thunderhead::storm_files
