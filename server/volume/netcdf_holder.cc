#include "volume/netcdf_holder.h"

#include <mutex>
#include <utility>

namespace thunderhead::volume {
namespace {

struct Held {
  std::mutex mutex;
  std::optional<NetcdfHolder> holder;
  const base::TimeSource* time = &base::SteadyTime();
};

Held& TheHeld() {
  static Held held;
  return held;
}

}  // namespace

std::optional<NetcdfHolder> NetcdfHolder::Now() {
  Held& held = TheHeld();
  const std::lock_guard lock(held.mutex);
  return held.holder;
}

void NetcdfHolder::MeasureBy(const base::TimeSource& time) {
  Held& held = TheHeld();
  const std::lock_guard lock(held.mutex);
  held.time = &time;
}

void NetcdfHolder::Begins(const std::string& path) {
  Held& held = TheHeld();
  const std::lock_guard lock(held.mutex);
  held.holder.emplace();
  held.holder->path = path;
  held.holder->since = held.time->Now();
}

void NetcdfHolder::Ends() {
  Held& held = TheHeld();
  const std::lock_guard lock(held.mutex);
  held.holder.reset();
}

}  // namespace thunderhead::volume
