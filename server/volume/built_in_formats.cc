// The list of storm formats. A new one is a file of its own, and a line here.
#include "volume/cf_format.h"
#include "volume/storm_format.h"
#include "volume/wrf_format.h"

namespace thunderhead::volume {

StormFormats StormFormats::BuiltIn() {
  StormFormats formats;
  formats.Add(MakeWrfFormat());
  formats.Add(MakeCfFormat());
  return formats;
}

}  // namespace thunderhead::volume
