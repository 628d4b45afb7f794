// Messages between this program and the reader of a storm file, each as one list of its members
// for both directions: `archive` is a Sender or a Receiver.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/time/time.h"
#include "volume/hydrometeor_fields.h"
#include "volume/storm_file.h"

namespace thunderhead::sandbox {

enum class Wanted : std::uint8_t { kProbe, kDescription, kVerticalGrid, kFields };

struct Request {
  Wanted wanted = Wanted::kProbe;
  std::string version;  // of the program that asks
  std::string path;     // for messages: the file itself is an open descriptor
  std::uint64_t record = 0;
  std::optional<volume::VerticalGrid> grid;
  std::uint64_t memory_bytes = 0;  // that reading may take, the file itself left out
  std::uint64_t shared_bytes = 0;  // of the shared memory, an open descriptor; 0: there is none
  std::uint32_t processor_s = 0;
};

// Replies: any number of the first two, then one of the others.
enum class Reply : std::uint8_t { kProgress, kLog, kError, kProbed, kDescription, kGrid, kFields };

// A line of the reader's log, or, of Reply::kError, a status.
struct Note {
  std::int32_t code = 0;  // spdlog's level, or absl's status code
  std::string text;
};

template <typename Archive, typename Value>
void VisitOptional(Archive& archive, std::optional<Value>& value) {
  std::uint8_t has = value.has_value() ? 1 : 0;
  archive(has);
  Value known = value.value_or(Value{});
  archive(known);
  value = has == 1 ? std::optional(known) : std::nullopt;
}

template <typename Archive>
void Visit(Archive& archive, Request& request) {
  archive(request.wanted);
  archive(request.version);
  archive(request.path);
  archive(request.record);
  VisitOptional(archive, request.grid);
  archive(request.memory_bytes);
  archive(request.shared_bytes);
  archive(request.processor_s);
}

template <typename Archive>
void Visit(Archive& archive, Note& note) {
  archive(note.code);
  archive(note.text);
}

template <typename Archive>
void Visit(Archive& archive, volume::VerticalGrid& grid) {
  archive(grid);
}

// All but the reader and the version. Times travel as seconds and nanoseconds since 1970.
template <typename Archive>
void Visit(Archive& archive, volume::StormFile& file) {
  archive(file.cells);
  archive(file.dx_m);
  archive(file.dy_m);
  std::vector<std::int64_t> seconds;
  std::vector<std::int64_t> nanoseconds;
  for (const absl::Time time : file.times) {
    seconds.push_back(absl::ToUnixSeconds(time));
    nanoseconds.push_back(absl::ToInt64Nanoseconds(time - absl::FromUnixSeconds(seconds.back())));
  }
  archive(seconds);
  archive(nanoseconds);
  file.times.clear();
  nanoseconds.resize(seconds.size());
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    file.times.push_back(absl::FromUnixSeconds(seconds[i]) + absl::Nanoseconds(nanoseconds[i]));
  }
  archive(file.fields);
  archive(file.about);
  archive(file.domain);
  archive(file.run);
  VisitOptional(archive, file.latitude_deg);
  VisitOptional(archive, file.longitude_deg);
  archive(file.projection);
}

template <typename Archive>
void Visit(Archive& archive, volume::HydrometeorField& field) {
  archive(field.hydrometeor);
  archive(field.variable);
  archive(field.quantity);
  archive(field.concentration_kg_per_m3);
  archive(field.statistics);
  archive(field.sizes.origin);
  archive(field.sizes.name);
  archive(field.sizes.inverse_radius);
  archive(field.sizes.first_cell);
  archive(field.sizes.mean_radius_m);
}

template <typename Archive>
void Visit(Archive& archive, volume::HydrometeorFields& fields) {
  archive(fields.grid.cells);
  archive(fields.grid.spacing_m);
  archive(fields.grid.low_corner_m);
  auto count = static_cast<std::uint32_t>(fields.fields.size());
  archive(count);
  fields.fields.resize(std::min<std::size_t>(count, physics::kHydrometeorCount));
  for (volume::HydrometeorField& field : fields.fields) Visit(archive, field);
  archive(fields.terrain_height_m);
  archive(fields.land.texels);
  archive(fields.land.mean_albedo);
  archive(fields.land.mean_reflectance);
  archive(fields.air.blocks);
  archive(fields.air.kg_per_m3);
  archive(fields.motion.source);
  archive(fields.motion.variable);
  archive(fields.motion.turbulence);
  archive(fields.motion.ascent);
  archive(fields.motion.shear_m_per_s);
  archive(fields.motion.steering_m_per_s);
  archive(fields.motion.time_s);
  archive(fields.condensate);
}

}  // namespace thunderhead::sandbox
