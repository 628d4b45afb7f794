// Functions with which tests use hanging_storage.cc, a library that makes a program's storage hang.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace thunderhead::testing {

// A sanitizer's library must be the first library of a program, so these builds cannot preload
// another library.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kHasHangingStorage = false;
#else
inline constexpr bool kHasHangingStorage = true;
#endif

// While an object of this class lives, every program that is started loads the library.
class HangingStorage {
 public:
  // Sets LD_PRELOAD for programs that are started. `clock` is the path of a file from which such a
  // program reads its clock; without it the program uses the machine's clock.
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

// Makes calls hang that open the file `path`, or that use the contents of the folder `path`.
inline void HangAt(const std::string& path) { std::ofstream(path + ".hangs"); }

// Returns whether a call hangs at `path`.
inline bool Hangs(const std::string& path) { return std::filesystem::exists(path + ".hung"); }

// Lets the calls continue that hang at `path` now. Later calls hang again.
inline void Release(const std::string& path) { std::filesystem::remove(path + ".hung"); }

// Lets all calls continue.
inline void HangNoLonger(const std::string& path) {
  std::filesystem::remove(path + ".hangs");
  std::filesystem::remove(path + ".hung");
}

}  // namespace thunderhead::testing
