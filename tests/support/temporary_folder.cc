#include "tests/support/temporary_folder.h"

#include <cstdlib>

#include "base/status.h"

namespace thunderhead::testing {

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "thunderhead-XXXXXX").string();
  THUNDERHEAD_CHECK(mkdtemp(pattern.data()) != nullptr, pattern);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace thunderhead::testing
