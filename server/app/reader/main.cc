// thunderhead-reader: the confined process that reads one storm file. A program of its own, because
// it starts for every read and needs none of the libraries that the server loads.
#include <unistd.h>

#include "sandbox/reader_main.h"
#include "storm_files/storm_format.h"

int main() {
  _exit(thunderhead::sandbox::ReadStormFile(thunderhead::storm_files::StormFormats::BuiltIn()));
}
