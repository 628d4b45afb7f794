// GDAL, opened when somebody asks for a GeoTIFF: linked, it would bring a hundred libraries to
// every start of the program. Its interface in C, whose functions have kept their form since
// version 1.
#pragma once

#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <gdal_frmts.h>

#include "absl/status/statusor.h"

namespace thunderhead::product {

// Named as GDAL names them, so that its manual is theirs.
struct GdalLibrary {
  // Registers this format alone: others use netCDF-C and HDF5, which allow one thread at a time.
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

  // Opened once, and kept. FAILED_PRECONDITION names the package if it is not installed. Safe from
  // any thread.
  static absl::StatusOr<const GdalLibrary*> Get();
};

}  // namespace thunderhead::product
