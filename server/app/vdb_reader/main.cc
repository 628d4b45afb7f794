// thunderhead-vdb-reader: the confined process that reads one grid of an OpenVDB file. It is a
// separate program because loading OpenVDB would make every start of thunderhead-reader slower.
#include <unistd.h>

#include "interchange/vdb_reader_main.h"

int main() { _exit(thunderhead::interchange::ReadVdbFile()); }
