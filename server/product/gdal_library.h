// GDAL, loaded for the first GeoTIFF. Linking it would load a hundred libraries at every start of
// the program. It uses GDAL's C interface, whose functions have not changed since version 1.
#pragma once

#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <gdal_frmts.h>

#include "absl/status/statusor.h"

namespace thunderhead::product {

// Members have GDAL's names, so that its manual applies.
struct GdalLibrary {
  // Registers only this format. Others use netCDF-C and HDF5, which allow one thread at a time.
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

  // Loads the library once and keeps it. FAILED_PRECONDITION names the package if it is not
  // installed. Safe from any thread.
  static absl::StatusOr<const GdalLibrary*> Get();
};

}  // namespace thunderhead::product
