// The process-wide lock around netCDF-C and HDF5, which are not thread-safe. NetcdfFile and
// NetcdfWriter, which read and write netCDF for all libraries, hold it.
#pragma once

#include <hdf5.h>

#include <mutex>

namespace thunderhead::netcdf {

// A lock guard. It must exist during every call of netCDF-C or HDF5.
class NetcdfLock {
 public:
  NetcdfLock() : lock_(Mutex()) {
    // HDF5 prints an error for each failed look-up unless printing is switched off in the calling
    // thread. NetCDF-C switches printing off only in the thread that opens the first file.
    thread_local const herr_t silenced = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    static_cast<void>(silenced);
  }
  NetcdfLock(const NetcdfLock&) = delete;
  NetcdfLock& operator=(const NetcdfLock&) = delete;

 private:
  static std::mutex& Mutex() {
    static std::mutex mutex;
    return mutex;
  }

  std::lock_guard<std::mutex> lock_;
};

}  // namespace thunderhead::netcdf
