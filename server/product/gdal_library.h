// GDAL, which is loaded when the first GeoTIFF is made. If the program were linked with GDAL, each
// start would load a hundred libraries. Only GDAL's C functions are used, which have not changed
// since version 1.
#pragma once

#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <gdal_frmts.h>

#include "absl/status/statusor.h"

namespace thunderhead::product {

// GDAL's functions. The members have GDAL's names, so that its manual applies.
struct GdalLibrary {
  // Registers only the GeoTIFF format. Other formats use netCDF-C and HDF5, which allow one thread
  // at a time.
  decltype(&::GDALRegister_GTiff) RegisterGTiff = nullptr;
  decltype(&::GDALGetDriverByName) GetDriverByName = nullptr;
  decltype(&::GDALCreate) Create = nullptr;
  decltype(&::GDALSetGeoTransform) SetGeoTransform = nullptr;
  decltype(&::GDALSetProjection) SetProjection = nullptr;
  decltype(&::GDALSetMetadataItem) SetMetadataItem = nullptr;
  decltype(&::GDALDatasetRasterIO) DatasetRasterIo = nullptr;
  decltype(&::GDALClose) Close = nullptr;
  decltype(&::VSIGetMemFileBuffer) GetMemFileBuffer = nullptr;
  decltype(&::VSIUnlink) Unlink = nullptr;
  decltype(&::VSIFree) Free = nullptr;
  decltype(&::CPLPushErrorHandler) PushErrorHandler = nullptr;
  decltype(&::CPLPopErrorHandler) PopErrorHandler = nullptr;
  decltype(&::CPLQuietErrorHandler) QuietErrorHandler = nullptr;
  decltype(&::CPLGetLastErrorMsg) GetLastErrorMsg = nullptr;

  // Returns the library, which is loaded at the first call and kept. Returns FAILED_PRECONDITION,
  // with the package to install, if GDAL is missing or lacks a function. The result of the first
  // call, also an error, holds until the process ends. The function is safe to call from any
  // thread.
  static absl::StatusOr<const GdalLibrary*> Get();
};

}  // namespace thunderhead::product
