// An open netCDF file. The class reads text and numbers, and replaces all codes for missing values
// by NaN. This class does not depend on any model or storm. NetCDF-C and HDF5 are not thread-safe,
// so every call holds a lock of the whole process (NetcdfLock). No code outside of this folder may
// call netCDF-C.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::netcdf {

// What happens to a value that is too large for any quantity in a storm, such as infinity. Either
// reading fails, or the value becomes NaN.
enum class HugeValue { kRefused, kMissing };

class NetcdfFile {
 public:
  // Opens `path` for reading, or its bytes if they were registered (base::ReadFromMemory). Errors:
  // NOT_FOUND; PERMISSION_DENIED; INVALID_ARGUMENT (not a netCDF file); DATA_LOSS (truncated,
  // damaged, or without `group`); UNAVAILABLE (another program is writing it).
  //
  // The variables are those of the root group, or of `group` (one that Groups() returns) and the
  // groups around it.
  static absl::StatusOr<NetcdfFile> Open(const std::string& path, const std::string& group = "");

  NetcdfFile(NetcdfFile&& other) noexcept;
  NetcdfFile& operator=(NetcdfFile&& other) noexcept;
  ~NetcdfFile();

  // Returns whether `start` can be the start of a netCDF file.
  static bool BeginsLikeNetcdf(std::string_view start);

  // Checks an open file before anything parses it. Returns INVALID_ARGUMENT if it does not begin
  // like a netCDF file, and DATA_LOSS if it is empty. Returns UNAVAILABLE while another program
  // writes it, in which case HDF5 has locked it.
  static absl::Status CheckStart(const std::string& path, int file);

  const std::string& Path() const { return path_; }

  bool HasVariable(const std::string& variable) const;

  // Returns the full names of the groups in the file, "/les/fields" for example, without the root.
  // Returns at most 1000 names.
  std::vector<std::string> Groups() const;

  // Returns the names of all variables, in the file's order. Those of an inner group come first.
  std::vector<std::string> Variables() const;

  // Returns the names of the variable's dimensions, slowest first.
  absl::StatusOr<std::vector<std::string>> Dimensions(const std::string& variable) const;

  // Returns the length of the dimension, or nothing if there is no such dimension.
  std::optional<std::size_t> DimensionLength(const std::string& dimension) const;

  // Returns the lengths of the variable's dimensions, slowest first.
  absl::StatusOr<std::vector<std::size_t>> Shape(const std::string& variable) const;

  // These two functions return an attribute, or nothing if it is absent or has another type. An
  // empty `variable` means the global attributes.
  std::optional<std::string> TextAttribute(const std::string& variable,
                                           const std::string& attribute) const;
  std::optional<double> NumberAttribute(const std::string& variable,
                                        const std::string& attribute) const;
  // Returns the numbers of an attribute, or an empty array if it is absent or a text.
  std::vector<double> NumbersAttribute(const std::string& variable,
                                       const std::string& attribute) const;
  // Returns the names of a variable's attributes.
  std::vector<std::string> AttributesOf(const std::string& variable) const;
  // Returns a text attribute, or an empty text if it is absent. An attribute of another type is
  // returned as "(not text)". Readers refuse that text like any other text that they do not know.
  std::string TextOrEmpty(const std::string& variable, const std::string& attribute) const;

  // Returns the rows of a character variable, each up to its first NUL. A variable of one dimension
  // is one row.
  absl::StatusOr<std::vector<std::string>> ReadRows(const std::string& variable) const;

  // Returns how many values a record of the variable has, computed from its dimensions without
  // reading values. Returns DATA_LOSS if the number is larger than any memory can hold.
  absl::StatusOr<std::size_t> RecordLength(const std::string& variable) const;

  // Reads one record (an index of the slowest dimension) of a numeric variable. Unpacks values
  // (_Unsigned, scale_factor, add_offset). Missing values become NaN. They are the variable's fill
  // values (_FillValue, missing_value), values outside its valid range (valid_min, valid_max,
  // valid_range), NaN, and the codes that packing.h describes. Returns INVALID_ARGUMENT for other
  // values of magnitude 1e30 or more, infinities included, and if scale_factor or add_offset is not
  // one finite number. With HugeValue::kMissing such large values become NaN, too. Subnormal values
  // become zero. Reuses the memory of `values`.
  absl::Status ReadRecord(const std::string& variable, std::size_t record,
                          std::vector<float>& values, HugeValue huge = HugeValue::kRefused) const;

  // Reads a whole numeric variable in double precision, for coordinates. Missing values become NaN
  // as in ReadRecord, and so do all values of magnitude 1e30 or more.
  absl::StatusOr<std::vector<double>> ReadDoubles(const std::string& variable) const;

  // Reads a hyperslab of a variable. Missing values become NaN as in ReadRecord.
  absl::StatusOr<std::vector<float>> ReadPart(const std::string& variable,
                                              const std::vector<std::size_t>& start,
                                              const std::vector<std::size_t>& count) const;

 private:
  NetcdfFile(std::string path, int handle);
  static absl::StatusOr<NetcdfFile> OpenRoot(const std::string& path);
  // Checks the opened file. `bytes` is its size. The caller must hold NetcdfLock.
  static absl::StatusOr<NetcdfFile> Checked(const std::string& path, int handle,
                                            std::uintmax_t bytes);

  absl::Status ReadFloats(const std::string& variable, const std::vector<std::size_t>& start,
                          const std::vector<std::size_t>& count, std::vector<float>& values,
                          HugeValue huge) const;
  // A variable's id in netCDF-C, and that of its group.
  struct Variable {
    int group = -1;
    int id = -1;
  };
  // Finds a variable in the group or in one around it. Returns netCDF-C's error code. The caller
  // must hold NetcdfLock.
  int Find(const std::string& variable, Variable& found) const;
  // Finds the holder of attributes: a variable, or the group if `variable` is empty. The caller
  // must hold NetcdfLock.
  std::optional<Variable> FindHolder(const std::string& variable,
                                     const std::string& attribute) const;
  // Returns a variable if its type is an allowed numeric type and it has `rank` dimensions.
  // Otherwise returns INVALID_ARGUMENT. Every function that reads numbers calls this function
  // first. The caller must hold NetcdfLock.
  absl::StatusOr<Variable> NumbersId(const std::string& variable, std::size_t rank) const;
  absl::StatusOr<std::size_t> CountThatFits(const std::string& variable,
                                            const std::vector<std::size_t>& lengths,
                                            std::size_t bytes_each) const;
  absl::Status ReadError(const std::string& variable, int code) const;
  void Close();

  std::string path_;
  int handle_;
  int group_;
};

}  // namespace thunderhead::netcdf
