#include "runs/run_options.h"

#include <google/protobuf/util/json_util.h>

#include <filesystem>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "pipeline/plan.h"
#include "pipeline/sha256.h"
#include "service/messages/limits_check.h"

namespace thunderhead::runs {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::string ViewNameOf(const std::string& file) {
  std::string name = fs::path(file).stem().string();
  for (char& c : name) {
    if (!absl::ascii_isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '_' && c != '-') {
      c = '-';
    }
  }
  return name.empty() ? "view" : name;
}

absl::StatusOr<View> MakeView(const std::string& name, v1::Scene scene) {
  THUNDERHEAD_RETURN_IF_ERROR(service::CheckLimits(scene));
  if (scene.rendering().has_reference()) {
    return absl::InvalidArgumentError(
        "the reference draws only single images: use thunderhead render, or another technique");
  }
  std::string json;
  (void)google::protobuf::util::MessageToJsonString(scene, &json);
  return View{name, std::move(scene), pipeline::Sha256(json)};
}

absl::Status AddFormat(const ProductFormat& format, View& view) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckScene(format, view.scene));
  if (format.fingerprint.empty()) return absl::OkStatus();
  view.sha256 = pipeline::Sha256(absl::StrCat(view.sha256, "\n", format.fingerprint));
  return absl::OkStatus();
}

pipeline::OtherManifests OtherManifestsOf(const std::string& manifest, bool takes_over) {
  pipeline::OtherManifests others;
  std::error_code error;
  const fs::path folder = fs::path(manifest).parent_path();
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    const std::string name = entry.path().filename().string();
    if (absl::StartsWith(name, "manifest.") && absl::EndsWith(name, ".jsonl") &&
        name != fs::path(manifest).filename()) {
      const bool taken = takes_over && pipeline::IsManifestOfShare(name);
      (taken ? others.take_over : others.count).push_back(entry.path().string());
    }
  }
  return others;
}

}  // namespace thunderhead::runs
