// Linked into every test program that draws: its programs are strict (gl/strict_programs.h),
// however it is started.
#include <cstdlib>

namespace {

[[maybe_unused]] const int kStrict = setenv("THUNDERHEAD_STRICT_PROGRAMS", "1", 1);

}  // namespace
