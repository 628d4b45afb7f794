#include <malloc.h>

#include "desktop/app.h"

int main(int argc, char** argv) {
  // glibc would give each of many short-lived threads its own heap, which keeps freed pictures.
  // After weeks this would look like a memory leak, so the number of heaps is limited and large
  // blocks are mapped separately.
  constexpr int kMaxHeaps = 2;
  constexpr int kMappedFrom_bytes = 256 << 10;
  mallopt(M_ARENA_MAX, kMaxHeaps);
  mallopt(M_MMAP_THRESHOLD, kMappedFrom_bytes);
  const thunderhead::desktop::ParsedFlags parsed = thunderhead::desktop::ParseFlags(argc, argv);
  return parsed.flags ? thunderhead::desktop::RunDesktop(*parsed.flags) : parsed.exit_status;
}
