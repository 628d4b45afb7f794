// Tests that every member of a storm's description and fields arrives at the other end of the pipe.
// The comparisons name all members of a type by structured bindings, so this file does not compile
// until it compares a new member.
#include "sandbox/messages.h"

#include <unistd.h>

#include <array>
#include <chrono>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "sandbox/archive.h"

namespace thunderhead::sandbox {
namespace {

// Sends the message through a pipe, which is large enough for it, and returns what arrives.
template <typename Message>
Message Sent(const Message& message) {
  std::array<int, 2> pipe_ends{};
  EXPECT_EQ(pipe(pipe_ends.data()), 0);
  Message sent = message;
  Sender sender(pipe_ends[1]);
  Visit(sender, sent);
  close(pipe_ends[1]);
  Message received;
  Receiver receiver(pipe_ends[0], std::chrono::minutes(10), 1 << 20);
  Visit(receiver, received);
  EXPECT_TRUE(receiver.Ok());
  close(pipe_ends[0]);
  return received;
}

void ExpectEqual(const volume::ParticleSizes& a, const volume::ParticleSizes& b) {
  const auto& [origin, name, inverse_radius, first_cell, mean_radius_m] = a;
  EXPECT_EQ(origin, b.origin);
  EXPECT_EQ(name, b.name);
  EXPECT_EQ(inverse_radius, b.inverse_radius);
  EXPECT_EQ(first_cell, b.first_cell);
  EXPECT_EQ(mean_radius_m, b.mean_radius_m);
}

void ExpectEqual(const volume::FieldStatistics& a, const volume::FieldStatistics& b) {
  const auto& [minimum, maximum, mean_path, maximum_path, negative_cells, missing_cells] = a;
  EXPECT_EQ(minimum, b.minimum);
  EXPECT_EQ(maximum, b.maximum);
  EXPECT_EQ(mean_path, b.mean_water_path_kg_per_m2);
  EXPECT_EQ(maximum_path, b.maximum_water_path_kg_per_m2);
  EXPECT_EQ(negative_cells, b.negative_cells);
  EXPECT_EQ(missing_cells, b.missing_cells);
}

void ExpectEqual(const volume::HydrometeorField& a, const volume::HydrometeorField& b) {
  const auto& [hydrometeor, variable, quantity, concentration, statistics, sizes] = a;
  EXPECT_EQ(hydrometeor, b.hydrometeor);
  EXPECT_EQ(variable, b.variable);
  EXPECT_EQ(quantity, b.quantity);
  EXPECT_EQ(concentration, b.concentration_kg_per_m3);
  ExpectEqual(statistics, b.statistics);
  ExpectEqual(sizes, b.sizes);
}

void ExpectEqual(const volume::LandSurface& a, const volume::LandSurface& b) {
  const auto& [texels, mean_albedo, mean_reflectance] = a;
  EXPECT_TRUE(texels == b.texels);
  EXPECT_EQ(mean_albedo, b.mean_albedo);
  EXPECT_EQ(mean_reflectance, b.mean_reflectance);
}

void ExpectEqual(const volume::AirDensity& a, const volume::AirDensity& b) {
  const auto& [blocks, kg_per_m3] = a;
  EXPECT_EQ(blocks, b.blocks);
  EXPECT_EQ(kg_per_m3, b.kg_per_m3);
}

void ExpectEqual(const volume::AirMotion& a, const volume::AirMotion& b) {
  const auto& [source, variable, turbulence, ascent, shear, steering, time_s] = a;
  EXPECT_EQ(source, b.source);
  EXPECT_EQ(variable, b.variable);
  EXPECT_EQ(turbulence, b.turbulence);
  EXPECT_EQ(ascent, b.ascent);
  EXPECT_EQ(shear, b.shear_m_per_s);
  EXPECT_EQ(steering, b.steering_m_per_s);
  EXPECT_EQ(time_s, b.time_s);
}

// Returns fields whose members all differ from their defaults, except the borders.
volume::HydrometeorFields Fields() {
  volume::HydrometeorFields fields;
  fields.grid = {{1, 2, 3}, {10.0, 20.0, 30.0}, {-5.0, -6.0, 7.0}};
  fields.fields = {{.hydrometeor = physics::Hydrometeor::kSnow,
                    .variable = "QSNOW",
                    .quantity = volume::Quantity::kMassConcentration,
                    .concentration_kg_per_m3 = {1.0F, 2.0F},
                    .statistics = {-1.0F, 3.0F, 4.0, 5.0, 6, 7},
                    .sizes = {volume::SizeOrigin::kNumber, "QNSNOW", {8, 9}, 10, 11.0F}},
                   {.hydrometeor = physics::Hydrometeor::kHail, .variable = "QHAIL"}};
  fields.terrain_height_m = {12.0F, 13.0F};
  fields.land = {{{1, 2, 3, 4}}, 0.25, {0.5F, 0.6F, 0.7F}};
  fields.motion = {
      volume::TurbulenceSource::kEnergy, "TKE", {14}, {15}, {16.0, 17.0}, {18.0, 19.0}, 20.0};
  fields.air = {{21, 22}, {23.0F}};
  fields.condensate = {{0, 1, 2}, {1, 2, 3}};
  fields.true_north_deg = 24.0;
  return fields;
}

TEST(MessagesTest, EveryMemberOfTheFieldsArrives) {
  const volume::HydrometeorFields expected = Fields();
  const volume::HydrometeorFields received = Sent(expected);
  const auto& [grid, fields, terrain_m, land, borders, true_north_deg, motion, air, condensate] =
      received;
  EXPECT_EQ(grid, expected.grid);
  ASSERT_EQ(fields.size(), expected.fields.size());
  for (std::size_t i = 0; i < fields.size(); ++i) ExpectEqual(fields[i], expected.fields[i]);
  EXPECT_EQ(terrain_m, expected.terrain_height_m);
  ExpectEqual(land, expected.land);
  // These two members are not sent, because the storm store sets them later.
  EXPECT_EQ(borders, nullptr);
  EXPECT_EQ(true_north_deg, 0.0);
  ExpectEqual(motion, expected.motion);
  ExpectEqual(air, expected.air);
  EXPECT_EQ(condensate, expected.condensate);
}

TEST(MessagesTest, EveryMemberOfADescriptionArrives) {
  storm_files::StormFile expected;
  expected.path = "/storms/a.nc";
  expected.cells = {1, 2, 3};
  expected.dx_m = 4.0;
  expected.dy_m = 5.0;
  expected.times = {absl::FromUnixNanos(1), absl::FromUnixSeconds(6)};
  expected.fields = {physics::Hydrometeor::kRain, physics::Hydrometeor::kHail};
  expected.about = "about";
  expected.domain = 7;
  expected.run = "run";
  expected.run_start = absl::FromUnixSeconds(16);
  expected.calendar = storm_files::Calendar::k360Day;
  expected.grid = "grid";
  expected.latitude_deg = 8.0;
  expected.longitude_deg = 9.0;
  expected.middles = {{11.0, 12.0}, {13.0, 14.0}};
  expected.projection = "+proj=merc";
  expected.projections = {"+proj=merc", "+proj=merc +lat_ts=20"};
  expected.member = "mem05";
  expected.assumptions = {"one", "two"};
  expected.part = {.of = "part", .at_all_times = true};
  expected.parts = {"/storms/a.nc", "/storms/b.nc"};
  expected.others.resize(2);
  expected.others[0].member = "mem06";
  expected.others[1].times = {absl::FromUnixSeconds(7)};
  expected.first_record = 3;
  expected.version = expected.id = expected.device = 10;
  expected.modified_ns = 15;
  const storm_files::StormFile received = Sent(expected);
  const auto& [path, cells, dx_m, dy_m, grid, times, fields, about, domain, run, run_start,
               calendar, latitude_deg, longitude_deg, middles, projection, projections, member,
               assumptions, part, parts, reader, others, first_record, version, id, device,
               modified_ns] = received;
  EXPECT_EQ(cells, expected.cells);
  EXPECT_EQ(dx_m, expected.dx_m);
  EXPECT_EQ(dy_m, expected.dy_m);
  EXPECT_EQ(times, expected.times);
  EXPECT_EQ(fields, expected.fields);
  EXPECT_EQ(about, expected.about);
  EXPECT_EQ(domain, expected.domain);
  EXPECT_EQ(run, expected.run);
  EXPECT_EQ(run_start, expected.run_start);
  EXPECT_EQ(calendar, expected.calendar);
  EXPECT_EQ(grid, expected.grid);
  EXPECT_EQ(latitude_deg, expected.latitude_deg);
  EXPECT_EQ(longitude_deg, expected.longitude_deg);
  EXPECT_EQ(middles, expected.middles);
  EXPECT_EQ(projection, expected.projection);
  EXPECT_EQ(projections, expected.projections);
  EXPECT_EQ(member, expected.member);
  EXPECT_EQ(assumptions, expected.assumptions);
  EXPECT_EQ(part.of, expected.part.of);
  EXPECT_EQ(part.at_all_times, expected.part.at_all_times);
  ASSERT_EQ(others.size(), 2U);
  EXPECT_EQ(others[0].member, "mem06");
  EXPECT_EQ(others[1].times, expected.others[1].times);
  // The other members are not sent, because the server sets them itself.
  EXPECT_EQ(path, "");
  EXPECT_TRUE(parts.empty());
  EXPECT_EQ(reader, nullptr);
  EXPECT_EQ(first_record, 0U);
  for (const std::uint64_t number : {version, id, device}) EXPECT_EQ(number, 0U);
  EXPECT_EQ(modified_ns, 0);
}

}  // namespace
}  // namespace thunderhead::sandbox
