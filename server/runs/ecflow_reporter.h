// Reports the progress of a task to ecFlow with the program ecflow_client. It sets the meter
// "products" from 0 to 100 percent, the label "product" to the newest product, and the event
// "first" after the first product.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace thunderhead::runs {

class EcflowReporter {
 public:
  EcflowReporter();
  // Reports the last state, then ends.
  ~EcflowReporter();
  EcflowReporter(const EcflowReporter&) = delete;
  EcflowReporter& operator=(const EcflowReporter&) = delete;

  // Returns true if the program runs in a task of ecFlow, which sets ECF_NAME.
  static bool InTask();

  // Reports progress without waiting for ecFlow's server. Progress that was not reported yet is
  // replaced.
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
  // Only the reporter's own thread uses the following members.
  State told_;
  bool complained_ = false;
  std::thread thread_;
};

}  // namespace thunderhead::runs
