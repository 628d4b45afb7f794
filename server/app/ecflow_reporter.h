// Tells ecFlow how far a task is, by its program ecflow_client: the meter "products" from 0 to 100,
// the label "product" with the newest one, and the event "first" once there is one.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace thunderhead::app {

class EcflowReporter {
 public:
  EcflowReporter();
  // Tells the last that it was given.
  ~EcflowReporter();
  EcflowReporter(const EcflowReporter&) = delete;
  EcflowReporter& operator=(const EcflowReporter&) = delete;

  // True in a task of ecFlow: ECF_NAME is set.
  static bool InTask();

  // Never waits for ecFlow's server: what is newer goes in place of what was not told yet.
  void Tell(int done, int planned, const std::string& product);

 private:
  struct State {
    int percent = -1;
    std::string product;
    bool operator==(const State&) const = default;
  };

  void Run();
  void TellServer(const State& state);
  void Call(const std::string& argument, const std::string& value = "");

  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  State newest_;
  // Of the thread alone.
  State told_;
  bool complained_ = false;
  std::thread thread_;
};

}  // namespace thunderhead::app
