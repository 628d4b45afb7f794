// The list of storm formats. A new format needs a separate file, and a line here.
#include "storm_files/cf_format.h"
#include "storm_files/grib_format.h"
#include "storm_files/storm_format.h"
#include "storm_files/wrf_format.h"

namespace thunderhead::storm_files {

StormFormats StormFormats::BuiltIn() {
  StormFormats formats;
  formats.Add(MakeWrfFormat());
  formats.Add(MakeCfFormat());
  formats.Add(MakeGribFormat());
  return formats;
}

}  // namespace thunderhead::storm_files
