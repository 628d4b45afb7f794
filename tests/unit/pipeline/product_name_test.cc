#include "pipeline/product_name.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::pipeline {
namespace {

using ::testing::HasSubstr;

ProductKey Key() {
  ProductKey key;
  key.storm = "supercell";
  key.run = absl::FromCivil(absl::CivilSecond(2013, 5, 20, 12, 0, 0), absl::UTCTimeZone());
  key.valid = *key.run + absl::Hours(7) + absl::Minutes(40);
  key.time_index = 5;
  key.view = "west";
  return key;
}

std::string NameOf(const std::string& text, const ProductKey& key = Key()) {
  const auto name = ProductName::Parse("--product", text);
  if (!name.ok()) return std::string(name.status().message());
  const auto path = name->For(key);
  return path.ok() ? *path : std::string(path.status().message());
}

TEST(ProductName, FieldsAreFilledIn) {
  EXPECT_EQ(NameOf("out/{storm}_{run:%Y%m%d%H}_{valid:%Y%m%d_%H%M}_{lead:03d}_{view}.png"),
            "out/supercell_2013052012_20130520_1940_007_west.png");
  EXPECT_EQ(NameOf("{lead}-{lead_min:05d}-{time:02d}-{time}.png"), "7-00460-05-5.png");
  // The model can count in a calendar without leap years.
  ProductKey counted = Key();
  counted.lead = absl::Hours(9);
  EXPECT_EQ(NameOf("{lead}-{lead_min}.png", counted), "9-540.png");
  EXPECT_EQ(NameOf("{valid:%j}/{view}/plain.jpg"), "140/west/plain.jpg");
  ProductKey idealised = Key();
  idealised.valid = absl::FromCivil(absl::CivilSecond(1, 1, 1, 0, 10, 0), absl::UTCTimeZone());
  EXPECT_EQ(NameOf("{valid:%Y%m%d_%H%M}.png", idealised), "00010101_0010.png");
}

TEST(ProductName, WhatIsWrongIsNamed) {
  EXPECT_THAT(NameOf("{strom}.png"),
              HasSubstr("--product is '{strom}.png'; {strom}: is not one of"));
  EXPECT_THAT(NameOf("{valid}.png"), HasSubstr("{valid}: needs a time format"));
  EXPECT_THAT(NameOf("{valid:%Q}.png"), HasSubstr("needs a time format"));
  EXPECT_THAT(NameOf("{valid:%Y/%m}.png"), HasSubstr("needs a time format"));
  EXPECT_THAT(NameOf("{lead:d}.png"), HasSubstr("needs a width"));
  EXPECT_THAT(NameOf("{lead:099d}.png"), HasSubstr("needs a width"));
  EXPECT_THAT(NameOf("{storm:%Y}.png"), HasSubstr("is not one of"));
  EXPECT_THAT(NameOf("a{storm.png"), HasSubstr("an unmatched brace"));
  EXPECT_THAT(NameOf("storm}.png"), HasSubstr("an unmatched brace"));
  EXPECT_THAT(NameOf("out/"), HasSubstr("must name a file"));
  ProductKey unknown = Key();
  unknown.run.reset();
  EXPECT_THAT(NameOf("{run:%Y}.png", unknown), HasSubstr("do not say when their run began"));
  EXPECT_EQ(NameOf("{storm}.png", unknown), "supercell.png");
}

TEST(ProductName, ATextChoosesNoFolderAndForgesNoLine) {
  ProductKey key = Key();
  for (const char* text : {"../other", "/root", "a/b", "..", ".", "a\nb", "a\x1b[31mb", "\x7f"}) {
    key.storm = text;
    EXPECT_THAT(NameOf("out/{storm}/{view}.png", key), HasSubstr("cannot be part of a file name"));
    EXPECT_EQ(NameOf("out/{view}.png", key), "out/west.png");
  }
  key.view = "../west";
  EXPECT_THAT(NameOf("../out/{view}.png", key), HasSubstr("{view} is '../west'"));
  key.view = "..west";
  key.storm = "Unwetter Köln";
  EXPECT_EQ(NameOf("../out/{storm}{view}.png", key), "../out/Unwetter Köln..west.png");
}

TEST(ProductName, FolderIsTheDeepestThatAllShare) {
  EXPECT_EQ(ProductName::Parse("--product", "a/b/c_{view}.png")->Folder(), "a/b");
  EXPECT_EQ(ProductName::Parse("--product", "a/{storm}/{view}.png")->Folder(), "a");
  EXPECT_EQ(ProductName::Parse("--product", "{view}.png")->Folder(), ".");
  EXPECT_EQ(ProductName::Parse("--product", "/{view}.png")->Folder(), "/");
}

TEST(ProductName, TwoProductsOfOneNameAreRefused) {
  const auto name = *ProductName::Parse("--product", "{storm}_{lead:03d}_{view}.png");
  ProductKey later = Key();
  later.valid += absl::Minutes(10);
  const absl::Status same = CheckDistinct(name, {Key(), later});
  EXPECT_EQ(same.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(same.message()), HasSubstr("'supercell_007_west.png'"));
  EXPECT_THAT(std::string(same.message()), HasSubstr("2013-05-20T19:40:00Z"));
  EXPECT_THAT(std::string(same.message()), HasSubstr("2013-05-20T19:50:00Z"));
  later.valid += absl::Minutes(10);
  EXPECT_TRUE(CheckDistinct(name, {Key(), later}).ok());
}

}  // namespace
}  // namespace thunderhead::pipeline
