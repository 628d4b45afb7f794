// Tests the table of a scene's parts with every field of the scene message.
//
// tests/service/scene_parts.txt lists each field's part and the consequences of a change.
// THUNDERHEAD_UPDATE=1 rewrites the list after a change of the message or of the table.
#include "scene/scene_parts.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/scene_fields.h"

namespace thunderhead::scene {
namespace {

using ::testing::IsEmpty;
using thunderhead::testing::FieldValues;

constexpr char kListPath[] = THUNDERHEAD_SOURCE_DIR "/tests/service/scene_parts.txt";
constexpr std::array kStageNames = {"storm", "extinction", "light", "view", "tone", "nothing"};

// Returns the parts that differ between two scenes.
std::set<const ScenePart*> Changed(const Scene& a, const Scene& b) {
  std::set<const ScenePart*> parts;
  for (const ScenePart& part : SceneParts()) {
    if (!part.same(a, b)) parts.insert(&part);
  }
  return parts;
}

// Expects that the functions for whole scenes answer as the row of the only part that differs.
void ExpectAnswersOf(const ScenePart& part, const Scene& before, const Scene& after) {
  const Stage first = FirstDirtyStage(before, after);
  EXPECT_GE(first, part.stage) << part.name;
  if (part.first_dirty == nullptr) {
    EXPECT_EQ(first, part.stage) << part.name;
  }
  EXPECT_EQ(Agree(before, after, &ScenePart::light_correction), !part.light_correction)
      << part.name;
  EXPECT_EQ(Agree(before, after, &ScenePart::measured_error), !part.measured_error) << part.name;
}

// The consequences of a change of one field.
struct Consequences {
  const ScenePart* part = nullptr;
  Stage stage = Stage::kNothing;  // the first stage that any change of the field invalidates
};

// Adds the consequences of the field in one scene. Adds nothing if no value of the field changes
// the scene; scene_defaults_test.cc says which fields these are.
void Add(const FieldValues& values, std::map<std::string, Consequences>& fields) {
  const Scene& before = values.scenes.front();
  for (const Scene& after : values.scenes) {
    if (after == before) continue;
    const std::set<const ScenePart*> parts = Changed(before, after);
    ASSERT_EQ(parts.size(), 1U) << values.path << " belongs to " << parts.size()
                                << " parts; it must belong to one row of the table in "
                                   "server/scene/scene_parts.cc";
    Consequences& field = fields[values.path];
    ASSERT_TRUE(field.part == nullptr || field.part == *parts.begin()) << values.path;
    field.part = *parts.begin();
    field.stage = std::min(field.stage, FirstDirtyStage(before, after));
    ExpectAnswersOf(*field.part, before, after);
  }
}

// Returns the consequences of every field that changes the scene, by the field's path.
std::map<std::string, Consequences> EveryField() {
  std::map<std::string, Consequences> fields;
  for (const v1::Scene& scene : thunderhead::testing::ScenesWithEveryField()) {
    thunderhead::testing::VisitFields(scene,
                                      [&](const FieldValues& values) { Add(values, fields); });
  }
  return fields;
}

std::string LineOf(const std::string& path, const Consequences& field) {
  return absl::StrCat(path, ": ", std::string(field.part->name), ", ",
                      kStageNames[static_cast<std::size_t>(field.stage)],
                      field.part->light_correction ? ", light correction" : "",
                      field.part->measured_error ? ", measured error" : "");
}

std::set<std::string> Listed() {
  std::ifstream file(kListPath);
  std::set<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.insert(line);
  return lines;
}

// Returns the lines that are not in `others`.
std::set<std::string> Without(std::set<std::string> lines, const std::set<std::string>& others) {
  std::erase_if(lines, [&](const std::string& line) { return others.contains(line); });
  return lines;
}

TEST(SceneParts, EveryFieldOfTheMessageBelongsToOnePart) {
  std::set<std::string> lines;
  for (const auto& [path, field] : EveryField()) lines.insert(LineOf(path, field));
  EXPECT_GT(lines.size(), 80U);
  if (std::getenv("THUNDERHEAD_UPDATE") != nullptr) {
    std::ofstream file(kListPath);
    for (const std::string& line : lines) file << line << "\n";
    return;
  }
  const std::set<std::string> listed = Listed();
  EXPECT_THAT(Without(lines, listed), IsEmpty())
      << "check that these consequences are right, and list them by running this test with "
         "THUNDERHEAD_UPDATE=1";
  EXPECT_THAT(Without(listed, lines), IsEmpty()) << "these listed lines no longer hold";
}

// Every row of the table has a field, so no row is forgotten when its field is removed.
TEST(SceneParts, EveryPartHasAField) {
  std::set<std::string_view> parts;
  for (const auto& [path, field] : EveryField()) parts.insert(field.part->name);
  for (const ScenePart& part : SceneParts()) {
    if (part.name == "rendering.image_scale") continue;  // set by the server, not by a message
    EXPECT_TRUE(parts.contains(part.name)) << part.name;
  }
}

}  // namespace
}  // namespace thunderhead::scene
