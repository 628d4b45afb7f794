// A client's knowledge of its session: a plain value, copied to whoever shows it.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::client {

// How the connection stands.
enum class Link {
  kConnecting,  // for the first time
  kLive,
  kLost,     // comes back by itself
  kRefused,  // the server does not know the token, or its role may not; tried again slowly
  kGone,     // the session has ended
};

struct SessionState {
  std::uint64_t version = 0;  // counts the changes

  Link link = Link::kConnecting;
  std::string reason;  // of a link that is not live
  std::chrono::steady_clock::time_point retry_at{};
  int joined_count = 0;  // how often it was joined

  std::uint64_t viewer_id = 0;
  v1::Role role = v1::ROLE_UNSPECIFIED;
  std::string viewer_key;     // for others to join by
  std::string presenter_key;  // empty where this client came by the viewers' key

  v1::Scene scene;  // with every edit of this client
  std::uint64_t scene_revision = 0;
  v1::Presence presence;
  v1::Marks marks;
  v1::Pointers pointers;
  v1::TimesInMemory times_in_memory;
  std::uint64_t catalogue_revision = 0;
  std::optional<v1::Problem> problem;  // of the newest scene
  std::string notice;                  // the last refusal or event, for people
  int notice_count = 0;

  bool looks_around = false;
  v1::Camera own_camera;    // while it looks around
  v1::Camera shown_camera;  // of the newest frame shown, every value filled in
  v1::Sun shown_sun;

  // All marks, or their changes.
  void Take(const v1::Marks& told);

  bool Steers() const;
  bool Presents() const { return role == v1::ROLE_PRESENTER; }
  bool Alone() const { return presence.people_size() <= 1; }
  bool AsksControl() const;
  // Nobody steers, and whoever asks gets control at once.
  bool SteersWhoAsks() const;
  bool MayLookAround() const;
  bool MayMark() const;
  // Nothing for nobody.
  const v1::Person* Steerer() const;
  const v1::Person* PersonOf(std::uint64_t viewer_id) const;
  // A name to show: the person's own, or one by its role.
  std::string NameOf(const v1::Person& person) const;
  // The camera of the view that this client sees, every value filled in; of no kind before the
  // first frame.
  v1::Camera ViewCamera() const;
};

}  // namespace thunderhead::client
