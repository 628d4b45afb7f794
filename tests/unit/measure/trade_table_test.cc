#include "measure/trade_table.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::measure {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TradeRow Row(double milliseconds, double relative_rmse) {
  TradeRow row;
  row.milliseconds = milliseconds;
  row.relative_rmse = relative_rmse;
  scene::SetSlices(&row.setting.technique, static_cast<int>(milliseconds));
  return row;
}

const TradeTitle kTitle{"storm", "orbit", "a \"machine\"", {320, 200}, 64, 0.01};

TEST(TradeTable, RowsComeBackFromTheirText) {
  TradeRow row = Row(12.5, 0.25);
  row.setting = {scene::HalfAngle{.medium = {.transport = scene::Transport::kPaperLowAlbedo,
                                             .look = {.per_field_phase = false}},
                                  .slices = 64},
                 0.5, 60, 2.0, true};
  row.bytes = 12345;
  row.relative_bias = -0.125;
  row.flip = 0.0625;
  row.estimated_error = {0.26, 0.24, 0.28};
  const std::string head = CsvHead(kTitle);
  const auto rows = ReadCsv(head + CsvLine(row), head);
  ASSERT_TRUE(rows.ok()) << rows.status();
  ASSERT_EQ(rows->size(), 1U);
  EXPECT_EQ(rows->front().setting, row.setting);
  EXPECT_EQ(rows->front().bytes, row.bytes);
  EXPECT_EQ(rows->front().milliseconds, row.milliseconds);
  EXPECT_EQ(rows->front().relative_bias, row.relative_bias);
  EXPECT_EQ(rows->front().flip, row.flip);
  EXPECT_EQ(rows->front().estimated_error, row.estimated_error);
}

TEST(TradeTable, AnInterruptedLineIsMeasuredAgain) {
  const std::string head = CsvHead(kTitle);
  const std::string line = CsvLine(Row(1.0, 0.1));
  const auto rows = ReadCsv(head + line + line.substr(0, 30), head);
  ASSERT_TRUE(rows.ok()) << rows.status();
  EXPECT_EQ(rows->size(), 1U);
}

TEST(TradeTable, AnotherViewsFileIsNotGoneOnWith) {
  TradeTitle other = kTitle;
  other.view = "top-down";
  EXPECT_FALSE(ReadCsv(CsvHead(other), CsvHead(kTitle)).ok());
}

TEST(TradeTable, NonsenseIsNamed) {
  const std::string head = CsvHead(kTitle);
  const auto rows = ReadCsv(head + "half_angle,no_such_mode,1\n", head);
  EXPECT_THAT(std::string(rows.status().message()), HasSubstr("no_such_mode"));
}

TEST(TradeTable, TheFrontIsWhatNothingBeats) {
  std::vector<TradeRow> rows = {Row(1.0, 0.5), Row(2.0, 0.5), Row(3.0, 0.2), Row(4.0, 0.3),
                                Row(5.0, 0.1)};
  MarkPareto(&rows);
  std::vector<bool> pareto;
  for (const TradeRow& row : rows) pareto.push_back(row.pareto);
  EXPECT_THAT(pareto, ElementsAre(true, false, true, false, true));
}

TEST(TradeTable, EveryRowHasAMark) {
  std::vector<TradeRow> rows = {Row(1.0, 0.5), Row(3.0, 0.2)};
  MarkPareto(&rows);
  const std::string svg = TradeSvg(kTitle, rows);
  EXPECT_THAT(svg, HasSubstr("1 slices"));
  EXPECT_THAT(svg, HasSubstr("3 slices"));
  EXPECT_THAT(svg, HasSubstr("violet: cumulus surfaces"));
  EXPECT_THAT(TradeJson(kTitle, rows), HasSubstr("a \\\"machine\\\""));
}

}  // namespace
}  // namespace thunderhead::measure
