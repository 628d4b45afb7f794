#include "app/roster_timeouts_file.h"

#include <chrono>
#include <fstream>
#include <map>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/file_stamp.h"
#include "base/named_file.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

constexpr std::chrono::milliseconds kLookEvery{20};

using Seconds = std::chrono::duration<double>;

}  // namespace

absl::StatusOr<session::RosterTimeouts> ReadRosterTimeouts(const std::string& path) {
  THUNDERHEAD_RETURN_IF_ERROR(base::CheckRegularFile(path));
  std::ifstream file(path);
  if (!file.is_open()) return absl::NotFoundError(absl::StrCat("cannot read ", path));
  session::RosterTimeouts timeouts;
  const std::map<std::string, std::chrono::milliseconds*> members = {
      {"answer", &timeouts.answer},
      {"ask_again", &timeouts.ask_again},
      {"away", &timeouts.away},
      {"come_back", &timeouts.come_back},
      {"come_back_to_new_server", &timeouts.come_back_to_new_server},
      {"sign_of_life", &timeouts.sign_of_life},
      {"sign_of_life_in_all", &timeouts.sign_of_life_in_all},
  };
  for (std::string name; file >> name;) {
    const auto member = members.find(name);
    double seconds = 0.0;
    if (member == members.end() || !(file >> seconds) || !(seconds >= 0.0)) {
      return absl::InvalidArgumentError(absl::StrCat(
          path, ": '", name, "' must be the name of a timeout, with its seconds after it"));
    }
    *member->second = std::chrono::round<std::chrono::milliseconds>(Seconds(seconds));
  }
  return timeouts;
}

std::jthread FollowRosterTimeouts(std::string path,
                                  std::function<void(const session::RosterTimeouts&)> take) {
  return std::jthread(
      [path = std::move(path), take = std::move(take)](const std::stop_token& stop) {
        std::optional<base::FileStamp> taken;
        for (int times = 0; !stop.stop_requested(); std::this_thread::sleep_for(kLookEvery)) {
          const std::optional<base::FileStamp> stamp = base::StampOf(path);
          if (!stamp.has_value() || stamp == taken) continue;
          taken = stamp;
          if (const auto timeouts = ReadRosterTimeouts(path); timeouts.ok()) {
            take(*timeouts);
            spdlog::info("roster timeouts taken {} times", ++times);
          } else {
            spdlog::warn("{}", std::string(timeouts.status().message()));
          }
        }
      });
}

}  // namespace thunderhead::app
