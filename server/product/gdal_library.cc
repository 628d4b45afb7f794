#include "product/gdal_library.h"

#include <dlfcn.h>

#include <array>

#include "absl/strings/str_cat.h"

namespace thunderhead::product {
namespace {

// File names of the library: the version in Debian 12, then the name that a development package
// installs.
constexpr std::array<const char*, 2> kNames = {"libgdal.so.32", "libgdal.so"};

template <typename Function>
bool Find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  return function != nullptr;
}

absl::StatusOr<GdalLibrary> Open() {
  void* library = nullptr;
  for (const char* name : kNames) {
    if (library == nullptr) library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  }
  if (library == nullptr) {
    return absl::FailedPreconditionError(
        absl::StrCat("GeoTIFF needs GDAL, which is not installed (", dlerror(),
                     "); install Debian's package libgdal32 and restart thunderhead"));
  }
  GdalLibrary gdal;
  const bool whole = Find(library, "GDALRegister_GTiff", gdal.RegisterGTiff) &&
                     Find(library, "GDALGetDriverByName", gdal.GetDriverByName) &&
                     Find(library, "GDALCreate", gdal.Create) &&
                     Find(library, "GDALSetGeoTransform", gdal.SetGeoTransform) &&
                     Find(library, "GDALSetProjection", gdal.SetProjection) &&
                     Find(library, "GDALSetMetadataItem", gdal.SetMetadataItem) &&
                     Find(library, "GDALDatasetRasterIO", gdal.DatasetRasterIo) &&
                     Find(library, "GDALClose", gdal.Close) &&
                     Find(library, "VSIGetMemFileBuffer", gdal.GetMemFileBuffer) &&
                     Find(library, "VSIUnlink", gdal.Unlink) &&
                     Find(library, "VSIFree", gdal.Free) &&
                     Find(library, "CPLPushErrorHandler", gdal.PushErrorHandler) &&
                     Find(library, "CPLPopErrorHandler", gdal.PopErrorHandler) &&
                     Find(library, "CPLQuietErrorHandler", gdal.QuietErrorHandler) &&
                     Find(library, "CPLGetLastErrorMsg", gdal.GetLastErrorMsg);
  if (!whole) {
    return absl::FailedPreconditionError(
        absl::StrCat("the installed GDAL lacks a function that GeoTIFF needs (", dlerror(),
                     "); install Debian's package libgdal32 and restart thunderhead"));
  }
  gdal.RegisterGTiff();
  return gdal;
}

}  // namespace

absl::StatusOr<const GdalLibrary*> GdalLibrary::Get() {
  // The library is never closed; it stays loaded until the process ends.
  static const auto& library = *new absl::StatusOr<GdalLibrary>(Open());
  if (!library.ok()) return library.status();
  return &*library;
}

}  // namespace thunderhead::product
