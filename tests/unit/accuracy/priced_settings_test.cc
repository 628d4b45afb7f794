#include "accuracy/priced_settings.h"

#include <algorithm>
#include <string>

#include "accuracy/embedded_trade_tables.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::accuracy {
namespace {

using testing::HasSubstr;

const std::string kHead = "# storm: a storm\n# size: 160x107\n";
const std::string kNames =
    "renderer,mode,transport,slices,image_scale,jpeg_quality,milliseconds,relative_rmse\n";
const std::string kRow =
    "light_volume,per_field_phase_translucent,consistent,32,0.5,88,5.29,0.33\n";

std::string Complaint(const std::string& text) {
  return std::string(ReadPricedSettings(text).status().message());
}

TEST(PricedSettings, AreReadByTheNamesOfTheirColumns) {
  const auto table = ReadPricedSettings(
      kHead +
      "relative_rmse,flip,slices,transport,mode,renderer,milliseconds,jpeg_quality,image_scale\n"
      "0.25,0.1,64,paper,uniform_phase_low_albedo,half_angle,12.5,88,0.75\n");
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_EQ(table->size_px, glm::ivec2(160, 107));
  ASSERT_EQ(table->rows.size(), 1U);
  const PricedSetting& row = table->rows.front();
  EXPECT_EQ(row.setting,
            (Setting{scene::HalfAngle{.medium = {.transport = scene::Transport::kPaperLowAlbedo,
                                                 .look = {.per_field_phase = false}},
                                      .slices = 64},
                     0.75, 88}));
  EXPECT_EQ(row.milliseconds, 12.5);
  EXPECT_EQ(row.relative_rmse, 0.25);
}

TEST(PricedSettings, OnlyTheCommonestJpegQualityIsKept) {
  std::string other = kRow;
  other.replace(other.find(",88,"), 4, ",30,");
  const auto table = ReadPricedSettings(kHead + kNames + other + kRow + kRow);
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_EQ(table->rows.size(), 2U);
  for (const PricedSetting& row : table->rows) EXPECT_EQ(row.setting.jpeg_quality, 88);
}

TEST(PricedSettings, WhatScenesCannotAskForIsLeftOut) {
  const std::string names = "light_detail,precision," + kNames;
  const auto table =
      ReadPricedSettings(kHead + names + "1,half," + kRow + "2,half," + kRow + "1,single," + kRow);
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_EQ(table->rows.size(), 1U);
}

TEST(PricedSettings, TracedLightIsTold) {
  const auto table =
      ReadPricedSettings(kHead + "million_paths," + kNames + "0," + kRow + "0.3," + kRow);
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_EQ(table->rows[0].setting.million_paths, 0.0);
  EXPECT_EQ(table->rows[1].setting.million_paths, 0.3);
  EXPECT_THAT(Complaint(kHead + "million_paths," + kNames + "many," + kRow), HasSubstr("line 4"));
}

TEST(PricedSettings, WhatIsNotUnderstoodIsRefusedAndNamed) {
  EXPECT_THAT(Complaint(kHead + "light_color," + kNames + "blue," + kRow),
              HasSubstr("column 'light_color' is unknown"));
  EXPECT_THAT(Complaint(kHead + "renderer,mode\n"), HasSubstr("no column 'transport'"));
  EXPECT_THAT(Complaint(kNames + kRow), HasSubstr("add one such as '# size: 160x107'"));
  EXPECT_THAT(Complaint("# size: large\n" + kNames + kRow), HasSubstr("'large'"));
  EXPECT_THAT(Complaint(kHead + kNames), HasSubstr("no rows"));
  EXPECT_THAT(Complaint(""), HasSubstr("size"));
}

TEST(PricedSettings, ALineThatIsNoRowIsNamed) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string row = kRow;
    return kHead + kNames + kRow + row.replace(row.find(from), from.size(), to);
  };
  for (const std::string& text :
       {with("light_volume", "crystal_ball"), with("consistent", "magical"), with("32", "0"),
        with("0.5", "2.5"), with("5.29", "nan"), with("5.29", "-1"), with("0.33", "inf"),
        with(",88", ""), with("0.33", "0.33,1")}) {
    EXPECT_THAT(Complaint(text), HasSubstr("its line 5")) << text;
  }
}

// Reads the server's own tables. The test fails if a column or name is added to a table and no code
// reads it.
TEST(PricedSettings, TheTablesOfTheProjectAreUnderstood) {
  for (const std::string_view view : {"orbit", "spotter", "top-down"}) {
    const auto text = EmbeddedTradeTableTexts().find(view);
    ASSERT_NE(text, EmbeddedTradeTableTexts().end()) << view;
    const auto table = ReadPricedSettings(text->second);
    ASSERT_TRUE(table.ok()) << view << ": " << table.status();
    EXPECT_GT(table->rows.size(), 10U) << view;
  }
}

}  // namespace
}  // namespace thunderhead::accuracy
