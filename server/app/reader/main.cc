// thunderhead-reader: the confined process that reads one storm file. It is a separate program
// because it starts for every read and needs none of the server's libraries.
#include <unistd.h>

#include "sandbox/reader_main.h"
#include "storm_files/storm_format.h"

int main() {
  _exit(thunderhead::sandbox::ReadStormFile(thunderhead::storm_files::StormFormats::BuiltIn()));
}
