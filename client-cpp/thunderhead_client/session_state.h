// A client's knowledge of its session. The code that shows the session gets a copy.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::client {

// State of the connection.
enum class Link {
  kConnecting,  // the first attempt is running
  kLive,
  kLost,     // the connection was lost; the client reconnects automatically
  kRefused,  // the server refuses the token or its role; the client retries slowly
  kGone,     // the session has ended
};

struct SessionState {
  std::uint64_t version = 0;  // increases with every change of this state

  Link link = Link::kConnecting;
  std::string reason;  // why the link is not live
  std::chrono::steady_clock::time_point retry_at{};
  int joined_count = 0;  // number of times that the client has joined

  std::uint64_t viewer_id = 0;
  v1::Role role = v1::ROLE_UNSPECIFIED;
  std::string viewer_key;     // key with which others join
  std::string presenter_key;  // empty if this client joined by the viewers' key

  v1::Scene scene;  // the session's scene with every edit of this client
  std::uint64_t scene_revision = 0;
  v1::Presence presence;
  v1::Marks marks;
  v1::Pointers pointers;
  v1::TimesInMemory times_in_memory;
  std::uint64_t catalogue_revision = 0;
  std::optional<v1::Problem> problem;  // why the newest scene cannot be drawn
  std::string notice;                  // the last refusal or event, as text for people
  int notice_count = 0;

  bool looks_around = false;
  v1::Camera own_camera;    // valid while the client looks around
  v1::Camera shown_camera;  // camera of the newest frame shown, every value filled in
  v1::Sun shown_sun;

  // Updates `marks` from a message that contains either all marks or only changes.
  void Take(const v1::Marks& told);

  bool Steers() const;
  bool Presents() const { return role == v1::ROLE_PRESENTER; }
  bool Alone() const { return presence.people_size() <= 1; }
  bool AsksControl() const;
  // Returns true if a viewer who asks for control gets it at once, because no viewer steers.
  bool SteersWhoAsks() const;
  bool MayLookAround() const;
  bool MayMark() const;
  // Returns the person in control; null if no one is.
  const v1::Person* Steerer() const;
  const v1::Person* PersonOf(std::uint64_t viewer_id) const;
  // Returns a name to show: the person's own name, or one made from the role.
  std::string NameOf(const v1::Person& person) const;
  // Returns the camera of the view that this client sees, with every value filled in. Before the
  // first frame, the camera has no kind.
  v1::Camera ViewCamera() const;
};

}  // namespace thunderhead::client
