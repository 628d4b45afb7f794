#include "thunderhead_client/playback.h"

#include <memory>

#include "client-cpp/tests/cases/runners.h"

namespace thunderhead::client::testing {
namespace {

// A storm whose times are played.
struct Player {
  void Show(std::optional<int> time) { index = time.value_or(index); }
  Results Observed() const {
    return {{"index", JsonOf(static_cast<double>(index))}, {"playing", JsonOf(playback.playing())}};
  }

  Playback playback;
  int count = 0;
  int index = 0;
};

Playback::TimePoint At(double milliseconds) {
  return Playback::TimePoint(std::chrono::milliseconds(static_cast<long>(milliseconds)));
}

}  // namespace

Actions RunPlayback(Arguments& given) {
  const auto player = std::make_shared<Player>();
  Playback& playback = player->playback;
  player->count = static_cast<int>(given.Number("count"));
  player->index = static_cast<int>(given.Number("index"));
  playback.times_per_second =
      static_cast<float>(given.Number("times_per_second", playback.times_per_second));
  playback.loops = given.Flag("loops", playback.loops);
  Actions actions;
  actions["toggle"] = [=](Arguments&) {
    player->Show(player->playback.Toggle(player->index, player->count));
    return player->Observed();
  };
  actions["step"] = [=](Arguments& step) {
    const int by = static_cast<int>(step.Number("by"));
    player->playback.Pause();
    player->Show(Playback::Step(player->index, by, player->count));
    return player->Observed();
  };
  actions["count"] = [=](Arguments& step) {
    player->count = static_cast<int>(step.Number("count"));
    return player->Observed();
  };
  actions["tick"] = [=](Arguments& step) {
    const bool shown = step.Flag("shown");
    player->Show(
        player->playback.Advance(player->index, player->count, shown, At(step.Number("at_ms"))));
    return player->Observed();
  };
  actions["rates"] = [](Arguments&) -> Results {
    std::vector<Json> rates;
    rates.reserve(std::size(Playback::kRates));
    for (const float rate : Playback::kRates) rates.push_back(JsonOf(static_cast<double>(rate)));
    return {{"rates", JsonOf(rates)}};
  };
  return actions;
}

}  // namespace thunderhead::client::testing
