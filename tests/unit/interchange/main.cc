// The test program is also the reader of OpenVDB files that the tests start.
#include <gtest/gtest.h>
#include <unistd.h>

#include <string_view>

#include "interchange/vdb_reader_main.h"
#include "sandbox/reader_process.h"

int main(int argc, char** argv) {
  if (std::string_view(argv[0]) == thunderhead::sandbox::kReaderName) {
    _exit(thunderhead::interchange::ReadVdbFile());
  }
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
