// The messages between the server and the reader of a storm file. Each Visit function lists a
// message's members once, for both directions: `archive` is a Sender or a Receiver.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/time/time.h"
#include "base/utf8.h"
#include "storm_files/storm_file.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::sandbox {

// The largest number of files that one reader gets at once.
inline constexpr std::size_t kMostBundled = 20'000;

// kOther is for programs that read files of other kinds than storm files.
enum class Wanted : std::uint8_t {
  kProbe,
  kDescription,
  kDescriptions,
  kVerticalGrid,
  kFields,
  kOther
};

struct Request {
  Wanted wanted = Wanted::kProbe;
  std::string version;  // version of the program that asks
  std::string path;     // path for error messages; the file itself is passed as an open descriptor
  // 1 if the descriptor holds several files (file_bundle.h), else 0. For kDescriptions, the files
  // are described one by one. For other requests, they are together one time.
  std::uint8_t bundle = 0;
  std::vector<std::string> bundled;  // paths of these files; not sent, because the bundle has them
  std::uint64_t record = 0;
  std::optional<storm_files::ColumnWindow> window;  // for kFields
  std::int32_t stride = 1;                          // for kFields
  std::string part;  // for kOther: the name of the part of the file that is requested
  std::optional<storm_files::VerticalGrid> grid;
  std::uint64_t memory_bytes = 0;  // limit in bytes for reading, without the mapped file
  std::uint64_t shared_bytes = 0;  // size of the shared memory, which is an open descriptor; 0 if
                                   // there is none
  std::uint32_t processor_s = 0;
};

// The kinds of replies. To each request, a reader sends any number of kProgress and kLog, and then
// exactly one reply of another kind.
enum class Reply : std::uint8_t {
  kProgress,
  kLog,
  kError,
  kProbed,
  kDescription,
  kDescriptions,
  kGrid,
  kFields,
  kOther
};

// A line of the reader's log or, for Reply::kError, a status.
struct Note {
  std::int32_t code = 0;  // spdlog's level, or absl's status code
  std::string text;
};

// Returns the text of a note as one printable line that is short enough to be sent. The reader
// calls it because its library may quote a long text of the file. The server calls it again because
// a reader can be hostile.
inline std::string NoteText(std::string_view text) {
  constexpr std::size_t kMaxNoteBytes = 2000;
  return base::Printable(text, {.max_bytes = kMaxNoteBytes});
}

template <typename Archive, typename Value>
void VisitOptional(Archive& archive, std::optional<Value>& value) {
  std::uint8_t has = value.has_value() ? 1 : 0;
  archive(has);
  Value known = value.value_or(Value{});
  archive(known);
  value = has == 1 ? std::optional(known) : std::nullopt;
}

// Sends or receives at most `most` texts.
template <typename Archive>
void VisitTexts(Archive& archive, std::vector<std::string>& texts, std::size_t most) {
  auto count = static_cast<std::uint32_t>(std::min(texts.size(), most));
  archive(count);
  texts.resize(std::min<std::size_t>(count, most));
  for (std::string& text : texts) archive(text);
}

template <typename Archive>
void Visit(Archive& archive, Request& request) {
  archive(request.wanted);
  archive(request.version);
  archive(request.path);
  archive(request.bundle);
  archive(request.record);
  VisitOptional(archive, request.window);
  archive(request.stride);
  archive(request.part);
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
void Visit(Archive& archive, storm_files::VerticalGrid& grid) {
  archive(grid);
}

// The functions below use structured bindings with all members of a type. If a type gets a new
// member, its function therefore does not compile until it handles the member.

template <typename Archive>
void VisitOthers(Archive& archive, std::vector<storm_files::StormFile>& others);

// Sends all members except those that the server sets itself: `path`, `parts`, `reader`,
// `first_record`, `version`, `id`, `device` and `modified_ns`. Times are sent as seconds and
// nanoseconds since 1970.
template <typename Archive>
void Visit(Archive& archive, storm_files::StormFile& file) {
  auto& [path, cells, dx_m, dy_m, grid, times, fields, about, domain, run, run_start, calendar,
         latitude_deg, longitude_deg, middles, projection, projections, member, assumptions, part,
         parts, reader, others, first_record, version, id, device, modified_ns] = file;
  archive(cells);
  archive(dx_m);
  archive(dy_m);
  archive(grid);
  std::vector<std::int64_t> seconds;
  std::vector<std::int64_t> nanoseconds;
  for (const absl::Time time : times) {
    seconds.push_back(absl::ToUnixSeconds(time));
    nanoseconds.push_back(absl::ToInt64Nanoseconds(time - absl::FromUnixSeconds(seconds.back())));
  }
  archive(seconds);
  archive(nanoseconds);
  times.clear();
  nanoseconds.resize(seconds.size());
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    times.push_back(absl::FromUnixSeconds(seconds[i]) + absl::Nanoseconds(nanoseconds[i]));
  }
  archive(fields);
  archive(about);
  archive(domain);
  archive(run);
  std::optional<std::int64_t> run_start_s;
  if (run_start.has_value()) run_start_s = absl::ToUnixSeconds(*run_start);
  VisitOptional(archive, run_start_s);
  if (run_start_s.has_value()) run_start = absl::FromUnixSeconds(*run_start_s);
  archive(calendar);
  VisitOptional(archive, latitude_deg);
  VisitOptional(archive, longitude_deg);
  archive(middles);
  archive(projection);
  VisitTexts(archive, projections, times.size());
  archive(member);
  constexpr std::size_t kMostAssumptions = 100;
  VisitTexts(archive, assumptions, kMostAssumptions);
  archive(part.of);
  archive(part.at_all_times);
  VisitOthers(archive, others);
}

// Sends the other storms of a file, which have no others themselves.
template <typename Archive>
void VisitOthers(Archive& archive, std::vector<storm_files::StormFile>& others) {
  auto count = static_cast<std::uint32_t>(others.size());
  archive(count);
  others.resize(std::min<std::size_t>(count, storm_files::kMaxStorms));
  for (storm_files::StormFile& other : others) Visit(archive, other);
}

// The description of a file, or why it cannot be described. `code` is absl's status code. If it is
// 0, `file` is set, and otherwise `message`.
struct Description {
  std::int32_t code = 0;
  std::string message;
  storm_files::StormFile file;
};

template <typename Archive>
void Visit(Archive& archive, std::vector<Description>& descriptions) {
  auto count = static_cast<std::uint32_t>(descriptions.size());
  archive(count);
  descriptions.resize(std::min<std::size_t>(count, kMostBundled));
  for (Description& each : descriptions) {
    archive(each.code);
    archive(each.message);
    if (each.code == 0) Visit(archive, each.file);
  }
}

template <typename Archive>
void Visit(Archive& archive, volume::ParticleSizes& sizes) {
  auto& [origin, name, inverse_radius, first_cell, mean_radius_m] = sizes;
  archive(origin);
  archive(name);
  archive(inverse_radius);
  archive(first_cell);
  archive(mean_radius_m);
}

template <typename Archive>
void Visit(Archive& archive, volume::HydrometeorField& field) {
  auto& [hydrometeor, variable, quantity, concentration_kg_per_m3, statistics, sizes] = field;
  archive(hydrometeor);
  archive(variable);
  archive(quantity);
  archive(concentration_kg_per_m3);
  archive(statistics);
  Visit(archive, sizes);
}

template <typename Archive>
void Visit(Archive& archive, volume::LandSurface& land) {
  auto& [texels, mean_albedo, mean_reflectance] = land;
  archive(texels);
  archive(mean_albedo);
  archive(mean_reflectance);
}

template <typename Archive>
void Visit(Archive& archive, volume::AirDensity& air) {
  auto& [blocks, kg_per_m3] = air;
  archive(blocks);
  archive(kg_per_m3);
}

template <typename Archive>
void Visit(Archive& archive, volume::AirMotion& motion) {
  auto& [source, variable, turbulence, ascent, shear_m_per_s, steering_m_per_s, time_s] = motion;
  archive(source);
  archive(variable);
  archive(turbulence);
  archive(ascent);
  archive(shear_m_per_s);
  archive(steering_m_per_s);
  archive(time_s);
}

template <typename Archive>
void Visit(Archive& archive, volume::RegularGrid& grid) {
  auto& [cells, spacing_m, low_corner_m] = grid;
  archive(cells);
  archive(spacing_m);
  archive(low_corner_m);
}

// Sends all members except `borders` and `true_north_deg`, which the storm store sets.
template <typename Archive>
void Visit(Archive& archive, volume::HydrometeorFields& fields) {
  auto& [grid, of_hydrometeors, terrain_height_m, land, borders, true_north_deg, motion, air,
         condensate] = fields;
  Visit(archive, grid);
  auto count = static_cast<std::uint32_t>(of_hydrometeors.size());
  archive(count);
  of_hydrometeors.resize(std::min<std::size_t>(count, physics::kHydrometeorCount));
  for (volume::HydrometeorField& field : of_hydrometeors) Visit(archive, field);
  archive(terrain_height_m);
  Visit(archive, land);
  Visit(archive, air);
  Visit(archive, motion);
  archive(condensate);
}

}  // namespace thunderhead::sandbox
