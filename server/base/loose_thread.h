// A thread that may hang in a system call that nobody can end, as on a storage that has gone: it is
// left behind then, so what it runs must own all that it uses.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <thread>

namespace thunderhead::base {

class LooseThread {
 public:
  LooseThread() = default;
  LooseThread(std::string name, std::function<void()> run);
  // Waits for its end, for a few seconds; its owner must have told it to end before.
  ~LooseThread();
  LooseThread(LooseThread&&) noexcept = default;
  LooseThread& operator=(LooseThread&&) = delete;

  // Waits at most that long for it to end; true if it has.
  bool EndsWithin(std::chrono::milliseconds time) const;

  // Throws what it threw, once it has ended.
  void Rethrow() const { ended_.get(); }

  // It has been waited for already: it is joined if it has ended, and left behind if not.
  void LetGo() { LetGoAfter(std::chrono::seconds(0)); }

  // True if one was left behind in this process: it must end by _exit, as the thread may wake up
  // while what it uses is being destroyed.
  static bool AnyLeftBehind();

 private:
  static constexpr std::chrono::seconds kPatience{5};

  void LetGoAfter(std::chrono::seconds patience);

  std::string name_;
  std::shared_future<void> ended_;
  std::thread thread_;
};

}  // namespace thunderhead::base
