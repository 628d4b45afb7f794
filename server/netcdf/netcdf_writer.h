// A writer of one netCDF-4 file in memory. The caller writes the bytes to a disk, because netCDF-C
// does not say why a file cannot be written, such as a full disk. The writer holds NetcdfLock as
// long as it lives. It keeps the code of the first error; after an error, further calls do nothing.
#pragma once

#include <netcdf.h>

#include <string>
#include <vector>

#include "absl/types/span.h"
#include "netcdf/netcdf_lock.h"

namespace thunderhead::netcdf {

class NetcdfWriter {
 public:
  // `name` is a name for netCDF-C. No file with this name is created.
  explicit NetcdfWriter(const std::string& name);
  ~NetcdfWriter() { (void)Take(); }
  NetcdfWriter(const NetcdfWriter&) = delete;
  NetcdfWriter& operator=(const NetcdfWriter&) = delete;

  // Dimension and Variable define a dimension or a variable and return its id in netCDF-C.
  int Dimension(const char* name, std::size_t length);
  // Defines a variable, compressed if it has several dimensions. The last dimension runs fastest.
  int Variable(const char* name, nc_type type, const std::vector<int>& dimensions);

  void Text(int variable, const char* name, const std::string& text);
  void Numbers(int variable, const char* name, absl::Span<const double> numbers);
  void Number(int variable, const char* name, double number) {
    Numbers(variable, name, {&number, 1});
  }
  // Sets the variable's fill value, which marks cells without data.
  void Fill(int variable, float value);
  void EndDefinitions();

  // These two functions write all values of a variable.
  void Values(int variable, absl::Span<const float> values);
  void Values(int variable, absl::Span<const double> values);

  // Closes the file and returns its bytes. Returns an empty string if there was an error, or if
  // Take was called before.
  std::string Take();

  bool Good() const { return code_ == NC_NOERR; }
  int Code() const { return code_; }

 private:
  void Keep(int code) {
    if (code_ == NC_NOERR) code_ = code;
  }

  const NetcdfLock lock_;
  int file_ = 0;
  int code_ = NC_NOERR;
  bool open_ = false;
};

}  // namespace thunderhead::netcdf
