// The list of storm formats. A new format needs a separate file, and a line here.
#include "storm_files/at3d_format.h"
#include "storm_files/cf_format.h"
#include "storm_files/grib_format.h"
#include "storm_files/mystic_format.h"
#include "storm_files/shdom_format.h"
#include "storm_files/storm_format.h"
#include "storm_files/wrf_format.h"

namespace thunderhead::storm_files {

StormFormats StormFormats::BuiltIn() {
  StormFormats formats;
  formats.Add(MakeWrfFormat());
  formats.Add(MakeCfFormat());
  formats.Add(MakeGribFormat());
  formats.Add(MakeShdomFormat());
  formats.Add(MakeMysticFormat());
  formats.Add(MakeAt3dFormat());
  return formats;
}

}  // namespace thunderhead::storm_files
