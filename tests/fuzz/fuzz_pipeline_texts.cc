// Fuzzes small texts and bytes from outside: manifest lines, names of products, readiness rules,
// marks from the store, and what `thunderhead load` receives from a server.
#include <cstdint>
#include <string>

#include "load/web_wire.h"
#include "pipeline/manifest.h"
#include "pipeline/product_name.h"
#include "pipeline/readiness.h"
#include "store/mark_bytes.h"
#include "tests/fuzz/must.h"

namespace {

using namespace thunderhead;

using fuzz::Must;

void TakeLine(const std::string& text) {
  const auto entry = pipeline::FromLine(text);
  if (!entry.ok()) return;
  const std::string line = pipeline::ToLine(*entry);
  Must(line.find('\n') == std::string::npos);
  const auto again = pipeline::FromLine(line);
  Must(again.ok() && pipeline::ToLine(*again) == line);
}

void TakeName(const std::string& text) {
  const auto name = pipeline::ProductName::Parse("--output", text);
  if (!name.ok()) return;
  static_cast<void>(name->Folder());
  static_cast<void>(name->For({.storm = "storm",
                               .run = absl::FromUnixSeconds(0),
                               .valid = absl::FromUnixSeconds(3600),
                               .time_index = 1,
                               .view = "view"}));
}

void TakeReadiness(const std::string& text) {
  const auto policy = pipeline::ReadinessPolicy::Parse(text);
  if (!policy.ok()) return;
  const pipeline::SeenFile file{"wrfout_d01", 100, 0, absl::Seconds(9)};
  static_cast<void>(policy->WaitsFor(file, {file}, {"wrfout_d01", "wrfout_d01.done"}));
  policy->IsMarker(text);
  policy->Patience();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 6) {
    case 0:
      TakeLine(text);
      break;
    case 1:
      TakeName(text);
      break;
    case 2:
      TakeReadiness(text);
      break;
    case 3:
      if (const auto marks = store::MarksFrom(text); marks.ok()) store::ToBytes(*marks);
      break;
    case 4:
      static_cast<void>(load::StatusOfTrailers(text));
      break;
    default:
      static_cast<void>(load::UnaryMessage(text));
  }
  return 0;
}
