// Turns on strict shader programs (gl/strict_programs.h) in every test that draws. This file is
// linked into these tests, so it applies whatever way they are started.
#include <cstdlib>

namespace {

[[maybe_unused]] const int kStrict = setenv("THUNDERHEAD_STRICT_PROGRAMS", "1", 1);

}  // namespace
