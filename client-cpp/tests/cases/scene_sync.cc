#include "thunderhead_client/scene_sync.h"

#include <memory>

#include "client-cpp/tests/cases/runners.h"

namespace thunderhead::client::testing {
namespace {

// A client whose time and server the case controls.
struct Client {
  // Sends the scenes that may be sent now, and returns them.
  Json Send() {
    std::vector<Json> sends;
    while (steers) {
      const auto outgoing = sync.Next(now);
      if (!outgoing) break;
      tickets.push_back(outgoing->ticket);
      Json send;
      auto& fields = *send.mutable_struct_value()->mutable_fields();
      fields["scene"] = JsonOf(outgoing->scene);
      fields["expected_revision"] = JsonOf(static_cast<double>(outgoing->expected_revision));
      sends.push_back(send);
    }
    return JsonOf(sends);
  }
  Results Observed() {
    if (sync.TakeDiscarded()) ++discarded;
    return {{"scene", JsonOf(sync.scene())},
            {"settled", JsonOf(sync.Settled())},
            {"revision", JsonOf(static_cast<double>(sync.revision()))},
            {"discarded", JsonOf(static_cast<double>(discarded))}};
  }
  std::uint64_t TicketOf(Arguments& step) const {
    const auto sent = static_cast<std::size_t>(step.Number("sent"));
    if (sent >= tickets.size()) throw CaseError("no such scene was sent");
    return tickets.at(sent);
  }

  SceneSync sync;
  SceneSync::TimePoint now{};
  bool steers = false;
  int discarded = 0;
  std::vector<std::uint64_t> tickets;
};

SceneSync::Refusal RefusalOf(const std::string& reason) {
  if (reason == "stale") return SceneSync::Refusal::kStale;
  if (reason == "busy") return SceneSync::Refusal::kBusy;
  if (reason == "refused") return SceneSync::Refusal::kRefused;
  throw CaseError("the runner does not know the reason '" + reason + "'");
}

std::uint64_t RevisionOf(Arguments& step) {
  return static_cast<std::uint64_t>(step.Number("revision"));
}

// The actions of this client and its server.
void AddScenes(const std::shared_ptr<Client>& client, Actions& actions) {
  actions["told"] = [=](Arguments& step) {
    client->sync.Told(step.Read<v1::Scene>("scene"), RevisionOf(step));
    return client->Observed();
  };
  actions["edit"] = [=](Arguments& step) {
    client->sync.Edited(
        [change = step.Read<v1::Scene>("scene")](v1::Scene& scene) { scene.MergeFrom(change); });
    return client->Observed();
  };
  actions["refresh"] = [=](Arguments& step) {
    const auto before_ms =
        std::chrono::duration<double, std::milli>(client->now.time_since_epoch());
    const double at_ms = step.Number("at_ms", before_ms.count());
    client->now = SceneSync::TimePoint(std::chrono::milliseconds(static_cast<long>(at_ms)));
    const Json sends = client->Send();
    Results results = client->Observed();
    results["sends"] = sends;
    return results;
  };
  actions["taken"] = [=](Arguments& step) {
    client->sync.Taken(client->TicketOf(step), RevisionOf(step));
    return client->Observed();
  };
  actions["refused"] = [=](Arguments& step) {
    const SceneSync::Refusal refusal = RefusalOf(step.Text("reason"));
    client->sync.Refused(client->TicketOf(step), refusal, client->now);
    return client->Observed();
  };
}

// The actions of other viewers and of the connection.
void AddOthers(const std::shared_ptr<Client>& client, Actions& actions) {
  actions["steer"] = [=](Arguments&) {
    client->steers = true;
    client->sync.Keep();
    return client->Observed();
  };
  actions["hold"] = [=](Arguments&) {
    client->steers = false;
    return client->Observed();
  };
  actions["another_steers"] = [=](Arguments&) {
    client->steers = false;
    client->sync.Discard();
    return client->Observed();
  };
  actions["lose"] = [=](Arguments&) {
    client->steers = false;
    client->sync.Rejoined();
    return client->Observed();
  };
  actions["rejoin"] = [=](Arguments&) {
    client->sync.Rejoined();
    return client->Observed();
  };
}

}  // namespace

Actions RunSceneSync(Arguments& /*given*/) {
  const auto client = std::make_shared<Client>();
  Actions actions;
  AddScenes(client, actions);
  AddOthers(client, actions);
  return actions;
}

}  // namespace thunderhead::client::testing
