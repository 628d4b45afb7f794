#include "desktop/status_log.h"

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {
namespace {

const char* NameOf(client::Link link) {
  switch (link) {
    case client::Link::kConnecting:
      return "connecting";
    case client::Link::kLive:
      return "live";
    case client::Link::kLost:
      return "lost";
    case client::Link::kRefused:
      return "refused";
    case client::Link::kGone:
      return "gone";
  }
  return "";
}

const char* NameOf(Tool tool) {
  switch (tool) {
    case Tool::kNone:
      return "";
    case Tool::kCamera:
      return "camera";
    case Tool::kTime:
      return "time";
    case Tool::kLight:
      return "light";
    case Tool::kLook:
      return "look";
    case Tool::kFields:
      return "fields";
    case Tool::kMarks:
      return "marks";
  }
  return "";
}

const char* NameOf(Panel panel) {
  switch (panel) {
    case Panel::kNone:
      return "";
    case Panel::kStorms:
      return "storms";
    case Panel::kPeople:
      return "people";
    case Panel::kReadout:
      return "figures";
    case Panel::kDrawer:
      return "settings";
    case Panel::kHelp:
      return "keys";
  }
  return "";
}

std::string JsonString(const std::string& text) {
  google::protobuf::Value value;
  value.set_string_value(text);
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(value, &json);
  return status.ok() ? json : R"("")";
}

struct View {
  const char* kind = "none";
  double azimuth_deg = 0.0;
  // Camera position, orbit target or map centre, relative to the storm's centre.
  double x_m = 0.0;
  double y_m = 0.0;
};

View ViewOf(const Ui& ui) {
  const auto pose = client::PoseOf(ui.state.shown_camera);
  if (!pose) return {};
  if (const auto* orbit = std::get_if<client::OrbitPose>(&*pose)) {
    return {"orbit", orbit->azimuth_deg, orbit->target_m[0], orbit->target_m[1]};
  }
  if (const auto* spotter = std::get_if<client::SpotterPose>(&*pose)) {
    return {"spotter", spotter->azimuth_deg, spotter->place_m[0], spotter->place_m[1]};
  }
  const auto& top_down = std::get<client::TopDownPose>(*pose);
  return {"top_down", 0.0, top_down.center_m[0], top_down.center_m[1]};
}

// Returns the processor time of all threads of this process.
double ProcessorSeconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

}  // namespace

std::int64_t ResidentBytes() {
  std::ifstream file("/proc/self/statm");
  std::int64_t size_pages = 0;
  std::int64_t resident_pages = 0;
  file >> size_pages >> resident_pages;
  return resident_pages * sysconf(_SC_PAGESIZE);
}

RotatedFile::RotatedFile(std::string path, std::int64_t max_bytes)
    : path_(std::move(path)), max_bytes_(max_bytes) {
  if (!path_.empty()) file_.open(path_, std::ios::trunc);
}

void RotatedFile::Write(const std::string& line) {
  const auto size = static_cast<std::int64_t>(line.size()) + 1;
  if (bytes_ > 0 && bytes_ + size > max_bytes_) {
    file_.close();
    // A file that cannot be renamed, such as a pipe, is overwritten.
    std::rename(path_.c_str(), (path_ + ".1").c_str());
    file_.open(path_, std::ios::trunc);
    bytes_ = 0;
  }
  file_ << line << std::endl;
  bytes_ += size;
}

absl::Status StatusLog::CheckWritable(const std::string& path) {
  std::error_code ignored;
  // An existing pipe is not opened, because closing it again would end its reader.
  const bool other = std::filesystem::exists(path, ignored) &&
                     !std::filesystem::is_regular_file(path, ignored) &&
                     !std::filesystem::is_directory(path, ignored);
  if (path.empty() || other || std::ofstream(path, std::ios::app)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("cannot write the file of --status, '", path, "': ", std::strerror(errno)));
}

void StatusLog::Write(const Ui& ui, int view, const InputTally& input,
                      std::chrono::steady_clock::time_point now) {
  if (!file_.is_open() || now - last_ < interval_) return;
  last_ = now;
  const View camera = ViewOf(ui);
  const auto& people = ui.state.presence.people();
  const auto asking = std::count_if(people.begin(), people.end(),
                                    [](const v1::Person& each) { return each.asks_control(); });
  const v1::AccuracyReport& accuracy = ui.frame.accuracy();
  // The line contains the viewers' key, so that others can join. It never contains the presenter's
  // key.
  file_.Write(
      absl::StrFormat(
          R"({"t_s":%.3f,"link":"%s","reason":%s,"problem":%s,"notice":%s,"joined":%d,"role":"%s","steers":%s,"looks_around":%s,"people":%d,"asking":%d,)"
          R"("viewer_key":"%s","storm":"%s","times":%d,"time_index":%d,"revision":%d,"shown_revision":%d,"image_scale":%.3f,"traced_paths":%d,)"
          R"("camera":"%s","azimuth_deg":%.2f,"x_m":%.1f,"y_m":%.1f,"sun_azimuth_deg":%.2f,"sun_elevation_deg":%.2f,)"
          R"("refined":%s,"error":%.4f,"error_measured":%s,"marks":%d,"pointers":%d,"view":%d,)",
          std::chrono::duration<double>(now - start_).count(), NameOf(ui.state.link),
          JsonString(ui.state.reason),
          JsonString(ui.state.problem ? ui.state.problem->message() : ""),
          JsonString(ui.state.notice), ui.state.joined_count,
          ui.state.Presents() ? "presenter" : "viewer", ui.state.Steers() ? "true" : "false",
          ui.state.looks_around ? "true" : "false", ui.state.presence.people_size(), asking,
          ui.state.viewer_key, ui.state.scene.storm_id(), ui.time_count(), ui.time_index(),
          ui.state.scene_revision, ui.frame.scene_revision(), accuracy.image_scale(),
          ui.frame.modelled().traced_paths(), camera.kind, camera.azimuth_deg, camera.x_m,
          camera.y_m, ui.state.shown_sun.azimuth_deg(), ui.state.shown_sun.elevation_deg(),
          ui.frame.refined() ? "true" : "false", accuracy.estimated_error(),
          accuracy.measured() ? "true" : "false", ui.state.marks.marks_size(),
          ui.state.pointers.pointers_size(), view) +
      absl::StrFormat(
          R"("tool":"%s","panel":"%s","typing":%s,"edits":%d,"undo_step_open":%s,"keys":%d,"buttons":%d,"notches":%d,)"
          R"("pointer_x":%d,"pointer_y":%d,"drawings":%d,)",
          NameOf(ui.choices.tool), NameOf(ui.choices.panel), ui.typing ? "true" : "false", ui.edits,
          ui.history.IsOpen(now) ? "true" : "false", input.keys, input.buttons, input.notches,
          input.pointer_x, input.pointer_y, input.drawings) +
      absl::StrFormat(
          R"("encoding":"%s","width_px":%d,"height_px":%d,"frames":%d,"frames_per_s":%.2f,)"
          R"("latency_ms":%.1f,"bytes_per_s":%.0f,"decode_ms":%.2f,"dropped":%d,"scale":%.2f,)"
          R"("processor_s":%.3f,"resident_bytes":%d})",
          ui.encoding, ui.frame.width_px(), ui.frame.height_px(), ui.figures.frames,
          ui.figures.frames_per_s, ui.figures.latency_ms.value_or(0.0), ui.figures.bytes_per_s,
          ui.figures.decode_ms, ui.dropped, ui.scale, ProcessorSeconds(), ResidentBytes()));
}

}  // namespace thunderhead::desktop
