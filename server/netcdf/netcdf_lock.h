// The one lock of the process around netCDF-C and HDF5, which are not thread-safe. What reads and
// writes netCDF for all rooms includes it: NetcdfFile and NetcdfWriter.
#pragma once

#include <hdf5.h>

#include <mutex>

namespace thunderhead::netcdf {

// Held around every call of netCDF-C.
class NetcdfLock {
 public:
  NetcdfLock() : lock_(Mutex()) {
    // HDF5 prints failed look-ups unless switched off, thread by thread; netCDF does so only in the
    // thread that opens the first file.
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
