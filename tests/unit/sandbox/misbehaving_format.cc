#include "tests/unit/sandbox/misbehaving_format.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <map>
#include <thread>

#include "absl/strings/str_cat.h"
#include "sandbox/archive.h"
#include "sandbox/messages.h"
#include "volume/map_projection.h"

namespace thunderhead::sandbox {
namespace {

using storm_files::StormFile;
using volume::HydrometeorField;
using volume::HydrometeorFields;

// Tries the actions that an attacker who controls the reader process would try. Returns the names
// of the actions that succeeded.
std::string TryEverything() {
  std::string could;
  const auto note = [&could](bool done, const char* what) {
    if (done) absl::StrAppend(&could, what, " ");
  };
  note(open("/etc/passwd", O_RDONLY) >= 0, "open");
  note(open("/proc/self/exe", O_RDONLY) >= 0, "open-proc");
  note(open("/tmp/thunderhead-sandbox-test", O_CREAT | O_WRONLY, 0600) >= 0, "create");
  note(socket(AF_INET, SOCK_STREAM, 0) >= 0, "socket");
  note(socket(AF_UNIX, SOCK_STREAM, 0) >= 0, "unix-socket");
  const pid_t child = fork();
  if (child == 0) _exit(0);
  note(child > 0, "fork");
  note(execl("/bin/true", "true", nullptr) == 0, "exec");
  note(kill(getppid(), 0) == 0, "signal-parent");
  note(mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1,
            0) != MAP_FAILED,
       "executable-memory");
  note(unlink("/tmp/thunderhead-sandbox-test") == 0, "unlink");
  note(dup(STDOUT_FILENO) >= 0, "dup");
  for (int descriptor = 3; descriptor < 100; ++descriptor) {
    char byte = 0;
    note(read(descriptor, &byte, 1) >= 0, "inherited-descriptor");
  }
  return could;
}

[[noreturn]] void Spin() {
  for (volatile double x = 1.0;;) x = std::sqrt(x + 1.0);
}

absl::Status MisbehaveWhenDescribed(const std::string& name) {
  if (name == "crash") std::raise(SIGSEGV);
  if (name == "abort") std::abort();
  if (name == "hang") std::this_thread::sleep_for(std::chrono::hours(1));
  if (name == "spin") Spin();
  if (name == "leave") _exit(0);
  if (name == "killed") std::raise(SIGKILL);
  if (name == "chatter") {
    Sender server(STDOUT_FILENO);
    for (;;) {
      server(Reply::kProgress);
      server(0.5);
    }
  }
  if (name == "noise") {
    Sender server(STDOUT_FILENO);
    for (;;) server(std::uint64_t{0xf00dface5eed});
  }
  if (name == "huge") {
    Sender server(STDOUT_FILENO);
    server(Reply::kError);
    server(std::int32_t{3});
    server(std::uint64_t{1} << 60);
  }
  if (name == "memory") {
    std::vector<std::vector<char>> all;
    while (true) all.emplace_back(16 << 20, 'x');
  }
  if (name == "everything")
    return absl::InvalidArgumentError(absl::StrCat("[", TryEverything(), "]"));
  if (name == "rude") return absl::InvalidArgumentError("\x1b[2Jforged\nline \xff");
  if (name == "wordy") return absl::InvalidArgumentError(std::string(100'000, 'x'));
  return absl::OkStatus();
}

HydrometeorFields SoundFields() {
  HydrometeorFields fields;
  fields.grid = {{2, 3, 4}, {1000.0, 1000.0, 500.0}, {-1000.0, -1500.0, 0.0}};
  HydrometeorField field;
  field.variable = "qc";
  field.concentration_kg_per_m3.assign(24, 1e-3F);
  field.sizes.origin = volume::SizeOrigin::kNumber;
  field.sizes.inverse_radius.assign(24, 0x3c00);
  fields.fields = {field};
  fields.terrain_height_m.assign(6, 0.0F);
  fields.condensate = {{0, 0, 0}, {2, 3, 4}};
  return fields;
}

// Breaks one property of the fields on which other parts of the server rely.
void Spoil(const std::string& how, HydrometeorFields& fields) {
  HydrometeorField& field = fields.fields[0];
  const std::map<std::string, std::function<void()>> ways = {
      {"nan", [&] { field.concentration_kg_per_m3[5] = std::nanf(""); }},
      {"infinite",
       [&] { field.concentration_kg_per_m3[5] = std::numeric_limits<float>::infinity(); }},
      {"negative", [&] { field.concentration_kg_per_m3[5] = -1.0F; }},
      {"short", [&] { field.concentration_kg_per_m3.resize(23); }},
      {"kind", [&] { field.hydrometeor = static_cast<physics::Hydrometeor>(77); }},
      {"quantity", [&] { field.quantity = static_cast<volume::Quantity>(-1); }},
      {"sizes-beyond", [&] { field.sizes.first_cell = 1; }},
      {"sizes-far", [&] { field.sizes.first_cell = ~std::size_t{0} - 4; }},
      {"sizes-few", [&] { field.sizes.inverse_radius.resize(20); }},
      {"statistics", [&] { field.statistics.maximum = std::nanf(""); }},
      {"terrain", [&] { fields.terrain_height_m.resize(5); }},
      {"terrain-nan", [&] { fields.terrain_height_m[2] = std::nanf(""); }},
      {"land", [&] { fields.land.texels.resize(7); }},
      {"turbulence", [&] { fields.motion.turbulence.resize(23); }},
      {"source", [&] { fields.motion.source = static_cast<volume::TurbulenceSource>(9); }},
      {"shear", [&] { fields.motion.shear_m_per_s.x = HUGE_VAL; }},
      {"steering", [&] { fields.motion.steering_m_per_s.y = -151.0; }},
      {"time", [&] { fields.motion.time_s = HUGE_VAL; }},
      {"box", [&] { fields.condensate.high.z = 5; }},
      {"columns",
       [&] {
         fields.grid.cells = {3, 2, 4};
       }},
      {"cells", [&] { fields.grid.cells.z = -4; }},
      {"spacing", [&] { fields.grid.spacing_m.z = 0.0; }},
      {"corner", [&] { fields.grid.low_corner_m.x = HUGE_VAL; }},
  };
  if (const auto way = ways.find(how); way != ways.end()) way->second();
}

class MisbehavingReader final : public storm_files::RecordReader {
 public:
  explicit MisbehavingReader(std::string name) : name_(std::move(name)) {}

  absl::StatusOr<HydrometeorFields> Read(
      const storm_files::RecordPart&, const std::optional<storm_files::VerticalGrid>&,
      const storm_files::ReadCheckpoint& checkpoint) const override {
    if (checkpoint) static_cast<void>(checkpoint(0.5));
    HydrometeorFields fields = SoundFields();
    Spoil(name_, fields);
    if (name_ == "named") fields.fields[0].variable = absl::StrCat(getpid());
    if (name_ == "crash-reading") std::raise(SIGBUS);
    if (name_ == "mute-reading") close(STDOUT_FILENO);
    if (name_ == "mute-reading" || name_ == "hang-reading") {
      std::this_thread::sleep_for(std::chrono::hours(1));
    }
    if (name_ == "spin-reading") Spin();
    if (name_ == "chatty-reading") {
      // The loop never ends; the server must end the reader by its time limit.
      while (checkpoint) static_cast<void>(checkpoint(0.5));
    }
    return fields;
  }

  absl::StatusOr<storm_files::VerticalGrid> ReadVerticalGrid(std::size_t) const override {
    return storm_files::VerticalGrid{0.0, name_ == "grid" ? std::nan("") : 500.0, 4};
  }

 private:
  const std::string name_;
};

// Gives the file a place, by PROJ in this confined process or by a text that makes PROJ open a
// file.
void Place(const std::string& name, StormFile& file) {
  file.projection = "+proj=lcc +lat_1=30 +lat_2=60 +lat_0=38.5 +lon_0=-97 +R=6370000";
  const auto map = volume::MapProjection::Open(file.projection);
  const auto place = map.ok() ? map->PlaceOf({700'000.0, 300'000.0}) : std::nullopt;
  if (!place.has_value()) return;
  file.latitude_deg = place->latitude_deg;
  file.longitude_deg = place->longitude_deg;
  if (name == "grids") file.projection += " +nadgrids=/etc/passwd";
}

class MisbehavingFormat final : public storm_files::StormFormat {
 public:
  std::string_view Name() const override { return "a misbehaving file"; }
  std::string_view Example() const override { return "FILE.bad"; }
  std::string_view Requirement() const override { return "a misbehaving file"; }

  storm_files::FormatFit Sniff(const storm_files::UnknownFile& file) const override {
    return file.Path().ends_with(".bad") ? storm_files::FormatFit::kModelLayout
                                         : storm_files::FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const storm_files::UnknownFile& unknown) const override {
    const std::string name = std::filesystem::path(unknown.Path()).stem();
    if (absl::Status status = MisbehaveWhenDescribed(name); !status.ok()) return status;
    StormFile file;
    file.path = unknown.Path();
    file.cells = {2, 3, 4};
    file.dx_m = 1000.0;
    file.dy_m = 1000.0;
    file.times = {absl::FromUnixSeconds(name == "future" ? 1LL << 50 : 0)};
    file.fields = {physics::Hydrometeor::kCloud};
    file.about = name;
    if (name == "lambert" || name == "grids") Place(name, file);
    file.reader = std::make_shared<MisbehavingReader>(name);
    return file;
  }
};

}  // namespace

storm_files::StormFormats FormatsWithMisbehaving() {
  storm_files::StormFormats formats = storm_files::StormFormats::BuiltIn();
  formats.Add(std::make_shared<MisbehavingFormat>());
  return formats;
}

}  // namespace thunderhead::sandbox
