// One netCDF file, owned: reads text and numbers, with all codes for "no value" replaced by NaN.
// Knows no model and no storm. NetCDF-C and HDF5 are not thread-safe, so every call holds a lock of
// the whole process (NetcdfLock); no other code may call netCDF-C.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::netcdf {

class NetcdfFile {
 public:
  // Opens `path` for reading. Errors: NOT_FOUND; INVALID_ARGUMENT (no netCDF file); DATA_LOSS (cut
  // short or damaged); UNAVAILABLE (another program is writing it).
  static absl::StatusOr<NetcdfFile> Open(const std::string& path);

  // For a process that may open no file: from now on the file at `path`, and no other, is read from
  // these bytes, which must stay.
  static void ReadFromMemory(const std::string& path, std::span<const std::byte> bytes);

  NetcdfFile(NetcdfFile&& other) noexcept;
  NetcdfFile& operator=(NetcdfFile&& other) noexcept;
  ~NetcdfFile();

  // Checks an open file before anything parses it: INVALID_ARGUMENT if it does not begin as netCDF
  // does, DATA_LOSS if it is empty, UNAVAILABLE while another program writes it (HDF5 locks it
  // then).
  static absl::Status CheckStart(const std::string& path, int file);

  const std::string& Path() const { return path_; }

  bool HasVariable(const std::string& variable) const;

  // The names of all variables, in the file's order.
  std::vector<std::string> Variables() const;

  // The names of the variable's dimensions, slowest first.
  absl::StatusOr<std::vector<std::string>> Dimensions(const std::string& variable) const;

  // Length of the dimension, or nothing.
  std::optional<std::size_t> DimensionLength(const std::string& dimension) const;

  // Lengths of the variable's dimensions, slowest first.
  absl::StatusOr<std::vector<std::size_t>> Shape(const std::string& variable) const;

  // Attributes; nothing if absent or of another type. An empty `variable` means the global
  // attributes.
  std::optional<std::string> TextAttribute(const std::string& variable,
                                           const std::string& attribute) const;
  std::optional<double> NumberAttribute(const std::string& variable,
                                        const std::string& attribute) const;
  // A text attribute that is empty if absent. One of another type is "(not text)", which no reader
  // knows, so that it is refused like any other unknown text.
  std::string TextOrEmpty(const std::string& variable, const std::string& attribute) const;

  // The rows of a two-dimensional character variable, up to the first NUL each.
  absl::StatusOr<std::vector<std::string>> ReadRows(const std::string& variable) const;

  // How many values a record of the variable has, from its dimensions; reads none. DATA_LOSS if
  // that is more than any memory holds.
  absl::StatusOr<std::size_t> RecordLength(const std::string& variable) const;

  // One record (index of the slowest dimension) of a numeric variable: unpacked (scale_factor,
  // add_offset), missing values (the variable's fill values, anything of 1e30 or more, NaN,
  // infinities) as NaN, denormals as zero. Reuses the memory of `values`.
  absl::Status ReadRecord(const std::string& variable, std::size_t record,
                          std::vector<float>& values) const;

  // A whole numeric variable in double precision, for coordinates; missing values become NaN as
  // above.
  absl::StatusOr<std::vector<double>> ReadDoubles(const std::string& variable) const;

  // A hyperslab of a variable; missing values become NaN as above.
  absl::StatusOr<std::vector<float>> ReadPart(const std::string& variable,
                                              const std::vector<std::size_t>& start,
                                              const std::vector<std::size_t>& count) const;

 private:
  NetcdfFile(std::string path, int handle);
  // `bytes` is the size of the file. The caller holds NetcdfLock.
  static absl::StatusOr<NetcdfFile> Checked(const std::string& path, int handle,
                                            std::uintmax_t bytes);

  absl::Status ReadFloats(const std::string& variable, const std::vector<std::size_t>& start,
                          const std::vector<std::size_t>& count, std::vector<float>& values) const;
  // Returns the id of a variable whose type is in the allow-list of numbers and that has `rank`
  // dimensions. Every read of numbers begins here. INVALID_ARGUMENT for another type or rank. The
  // caller holds NetcdfLock.
  absl::StatusOr<int> NumbersId(const std::string& variable, std::size_t rank) const;
  absl::StatusOr<std::size_t> CountThatFits(const std::string& variable,
                                            const std::vector<std::size_t>& lengths,
                                            std::size_t bytes_each) const;
  absl::Status ReadError(const std::string& variable, int code) const;
  void Close();

  std::string path_;
  int handle_;
};

}  // namespace thunderhead::netcdf
