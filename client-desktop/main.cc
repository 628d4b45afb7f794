#include <malloc.h>

#include "desktop/app.h"

int main(int argc, char** argv) {
  // A heap for each of many short-lived threads, and freed pictures kept in them, would look like a
  // leak after weeks.
  constexpr int kMaxHeaps = 2;
  constexpr int kMappedFrom_bytes = 256 << 10;
  mallopt(M_ARENA_MAX, kMaxHeaps);
  mallopt(M_MMAP_THRESHOLD, kMappedFrom_bytes);
  const thunderhead::desktop::ParsedFlags parsed = thunderhead::desktop::ParseFlags(argc, argv);
  return parsed.flags ? thunderhead::desktop::RunDesktop(*parsed.flags) : parsed.exit_status;
}
