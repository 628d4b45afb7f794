// How tests use hanging_storage.cc, a library that makes a program's storage hang.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace thunderhead::testing {

// A sanitizer's library must be the first of a program.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kHasHangingStorage = false;
#else
inline constexpr bool kHasHangingStorage = true;
#endif

// While it lives, programs that are started load the library.
class HangingStorage {
 public:
  // `clock` names the file of the program's clock; by default the program has the machine's.
  explicit HangingStorage(const std::string& clock = "") {
    setenv("LD_PRELOAD", HANGING_STORAGE, 1);
    if (!clock.empty()) setenv("THUNDERHEAD_TEST_CLOCK", clock.c_str(), 1);
  }
  ~HangingStorage() {
    unsetenv("LD_PRELOAD");
    unsetenv("THUNDERHEAD_TEST_CLOCK");
  }
  HangingStorage(const HangingStorage&) = delete;
  HangingStorage& operator=(const HangingStorage&) = delete;
};

// Makes calls hang that open the file, or that use what is in the folder.
inline void HangAt(const std::string& path) { std::ofstream(path + ".hangs"); }

// Returns whether a call hangs there.
inline bool Hangs(const std::string& path) { return std::filesystem::exists(path + ".hung"); }

// Lets the calls continue that hang there now. Later ones hang.
inline void Release(const std::string& path) { std::filesystem::remove(path + ".hung"); }

// Lets all calls continue.
inline void HangNoLonger(const std::string& path) {
  std::filesystem::remove(path + ".hangs");
  std::filesystem::remove(path + ".hung");
}

}  // namespace thunderhead::testing
