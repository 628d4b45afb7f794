// A netCDF-4 file being written. Holds the lock of netCDF-C as long as it lives, and keeps the
// first error, after which calls do nothing.
#pragma once

#include <netcdf.h>

#include <string>
#include <vector>

#include "absl/types/span.h"
#include "netcdf/netcdf_lock.h"

namespace thunderhead::netcdf {

class NetcdfWriter {
 public:
  // At `path`, in place of what is there; or in memory, where `path` only names it to others who
  // wait for the lock.
  enum class Where { kOnDisk, kInMemory };
  explicit NetcdfWriter(const std::string& path, Where where = Where::kOnDisk);
  ~NetcdfWriter() { Close(); }
  NetcdfWriter(const NetcdfWriter&) = delete;
  NetcdfWriter& operator=(const NetcdfWriter&) = delete;

  // Each returns what netCDF-C calls it by.
  int Dimension(const char* name, std::size_t length);
  // Compressed if it has dimensions, of which the last runs fastest.
  int Variable(const char* name, nc_type type, const std::vector<int>& dimensions);

  void Text(int variable, const char* name, const std::string& text);
  void Numbers(int variable, const char* name, absl::Span<const double> numbers);
  void Number(int variable, const char* name, double number) {
    Numbers(variable, name, {&number, 1});
  }
  // The value of cells without one.
  void Fill(int variable, float value);
  void EndDefinitions();

  // All of a variable.
  void Values(int variable, absl::Span<const float> values);
  void Values(int variable, absl::Span<const double> values);

  // The file is whole after this if it is still good.
  void Close();
  // The same; the bytes of one in memory.
  std::string Take();

  bool Good() const { return code_ == NC_NOERR; }
  int Code() const { return code_; }

 private:
  void Keep(int code) {
    if (code_ == NC_NOERR) code_ = code;
  }

  const NetcdfLock lock_;
  const Where where_;
  int file_ = 0;
  int code_ = NC_NOERR;
  bool open_ = false;
};

}  // namespace thunderhead::netcdf
