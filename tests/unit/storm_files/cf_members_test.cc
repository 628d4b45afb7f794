// Tests of CF files with the members of an ensemble. Each member is a separate storm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/unit/storm_files/cf_file_test.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::ElementsAre;
using testing::SyntheticCf;

// A storm's name and the largest water paths of its cloud at each of its times.
struct MemberStorm {
  std::string id;
  std::vector<double> paths_kg_per_m2;
};

class CfMembers : public CfFileTest {
 protected:
  // Returns the storms in what `path` names.
  std::vector<MemberStorm> StormsIn(const std::string& path) {
    std::vector<MemberStorm> storms;
    const auto store = storm_store::StormStore::Open({path}, {.read_ahead = 0});
    EXPECT_TRUE(store.ok()) << store.status();
    if (!store.ok()) return storms;
    for (const auto& storm : (*store)->Storms()) {
      MemberStorm& found = storms.emplace_back(MemberStorm{storm->id, {}});
      for (std::size_t time = 0; time < storm->times.size(); ++time) {
        const auto fields = (*store)->Get(storm->id, static_cast<int>(time), {});
        EXPECT_TRUE(fields.ok()) << fields.status();
        if (!fields.ok()) continue;
        found.paths_kg_per_m2.push_back(
            (*fields)->fields[0].statistics.maximum_water_path_kg_per_m2);
      }
    }
    return storms;
  }

  std::vector<MemberStorm> StormsOf(const SyntheticCf& file) {
    Write(file);
    return StormsIn(path_);
  }
};

// Expects a storm with this name and these water paths.
auto IsStorm(const std::string& id, const std::vector<double>& paths_kg_per_m2) {
  std::vector<::testing::Matcher<double>> near;
  for (const double path : paths_kg_per_m2) near.push_back(::testing::DoubleNear(path, 1e-5));
  return ::testing::AllOf(
      ::testing::Field(&MemberStorm::id, id),
      ::testing::Field(&MemberStorm::paths_kg_per_m2, ::testing::ElementsAreArray(near)));
}

// Returns cloud water in the lowest layer, of 500 m, at two times. A member with the index m has
// (m + 1) 1e-4 kg m-3 at the first time, and ten times as much at the second.
SyntheticCf Ensemble(const std::string& dimension, std::vector<double> numbers) {
  SyntheticCf file = testing::ExtinctionFile(6, 4, 4, 1000.0, 1000.0, 500.0, {});
  file.coordinates.push_back({"time", {0.0, 1.0}, {{"units", "hours since 2013-05-20"}}, {}});
  file.coordinates.push_back({dimension, std::move(numbers), {{"units", "1"}}, {}});
  file.variables[0] = {
      "qc", {"time", dimension, "z", "y", "x"}, {{"units", "kg m-3"}}, [=](const Index& at) {
        if (at.at("z") != 0) return 0.0;
        return 1e-4 * static_cast<double>(at.at(dimension) + 1) * (at.at("time") == 0 ? 1.0 : 10.0);
      }};
  return file;
}

TEST_F(CfMembers, EachMemberIsAStorm) {
  SyntheticCf file = Ensemble("number", {1.0, 5.0, 12.0});
  file.coordinates.back().attributes["standard_name"] = "realization";
  EXPECT_THAT(StormsOf(file),
              ElementsAre(IsStorm("cloud-mem01", {0.05, 0.5}), IsStorm("cloud-mem05", {0.1, 1.0}),
                          IsStorm("cloud-mem12", {0.15, 1.5})));
  EXPECT_THAT(StormsIn(path_ + "/mem05"), ElementsAre(IsStorm("cloud-mem05", {0.1, 1.0})));
}

TEST_F(CfMembers, AreKnownByTheNameOfTheirDimension) {
  for (const char* name : {"realization", "member", "ensemble"}) {
    // Members whose numbers cannot be used count from 0.
    for (const std::vector<double>& numbers : {std::vector{0.5, 1.5}, {3.0, 3.0}, {-1.0, 0.0}}) {
      EXPECT_THAT(
          StormsOf(Ensemble(name, numbers)),
          ElementsAre(IsStorm("cloud-mem00", {0.05, 0.5}), IsStorm("cloud-mem01", {0.1, 1.0})))
          << name;
    }
  }
}

// The heights of the layers differ between these members, and the rain is the same.
TEST_F(CfMembers, AVariableMayBeOfEachMemberOrOfAll) {
  SyntheticCf file = Ensemble("member", {0.0, 1.0});
  file.coordinates[2] = {"z", {1.0, 2.0, 3.0, 4.0}, {{"units", "1"}, {"axis", "Z"}}, {}};
  file.variables[0].value = [](const Index& at) { return at.at("z") == 0 ? 1e-4 : 0.0; };
  file.variables.push_back(
      {"HHL", {"member", "faces", "y", "x"}, {{"units", "m"}}, [](const Index& at) {
         return 200.0 * static_cast<double>(at.at("faces")) *
                static_cast<double>(at.at("member") + 1);
       }});
  file.coordinates.push_back({"faces", {1.0, 2.0, 3.0, 4.0, 5.0}, {{"axis", "Z"}}, {}});
  file.variables.push_back({"qr", {"z", "y", "x"}, {{"units", "kg m-3"}}, [](const Index& at) {
                              return at.at("z") == 1 ? 1e-4 : 0.0;
                            }});
  EXPECT_THAT(StormsOf(file), ElementsAre(IsStorm("cloud-mem00", {0.02, 0.02}),
                                          IsStorm("cloud-mem01", {0.04, 0.04})));
}

// The heights are in another file, which belongs to all members.
TEST_F(CfMembers, HeightsMayBeInAnotherFile) {
  SyntheticCf times = Ensemble("member", {2.0, 3.0});
  times.coordinates[2] = {"z", {1.0, 2.0, 3.0, 4.0}, {{"units", "1"}, {"axis", "Z"}}, {}};
  times.coordinates[3].values = {0.0};
  SyntheticCf heights = times;
  times.variables[0].value = [](const Index& at) {
    return at.at("z") == 0 ? 1e-4 * static_cast<double>(at.at("member") + 1) : 0.0;
  };
  heights.coordinates = {times.coordinates[0],
                         times.coordinates[1],
                         {"faces", {1.0, 2.0, 3.0, 4.0, 5.0}, {{"axis", "Z"}}, {}}};
  heights.variables = {{"HHL", {"faces", "y", "x"}, {{"units", "m"}}, [](const Index& at) {
                          return 200.0 * static_cast<double>(at.at("faces"));
                        }}};
  const std::string run = folder_.File("run");
  std::filesystem::create_directory(run);
  testing::WriteCf(times, run + "/time.nc");
  testing::WriteCf(heights, run + "/heights.nc");
  EXPECT_THAT(StormsIn(run),
              ElementsAre(IsStorm("run-mem02", {0.02}), IsStorm("run-mem03", {0.04})));
}

}  // namespace
}  // namespace thunderhead::storm_files
