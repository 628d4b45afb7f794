// Makes the programs of every test that draws strict (gl/strict_programs.h). It is linked into
// these tests, so it applies however they are started.
#include <cstdlib>

namespace {

[[maybe_unused]] const int kStrict = setenv("THUNDERHEAD_STRICT_PROGRAMS", "1", 1);

}  // namespace
