// Tests of the program's flags.
#include "desktop/flags.h"

#include <string>
#include <vector>

#include "gtest/gtest.h"

namespace thunderhead::desktop {
namespace {

ParsedFlags Parse(std::vector<std::string> words) {
  words.insert(words.begin(), "thunderhead-desktop");
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (std::string& word : words) argv.push_back(word.data());
  return ParseFlags(static_cast<int>(argv.size()), argv.data());
}

std::string ServerOf(const std::vector<std::string>& words) {
  const ParsedFlags parsed = Parse(words);
  return parsed.flags.has_value() ? parsed.flags->access.address : "refused";
}

TEST(Flags, WithoutAServerItIsThatOfThisMachine) {
  EXPECT_EQ(ServerOf({}), "localhost:50051");
  EXPECT_EQ(ServerOf({"--kiosk"}), "localhost:50051");
  EXPECT_EQ(ServerOf({"--name", "Room 5:2"}), "localhost:50051");
  EXPECT_EQ(ServerOf({"--key", "a:1", "--full-screen"}), "localhost:50051");
  EXPECT_EQ(ServerOf({"--kiosk", "--views", "a:1.json", "b.json"}), "localhost:50051");
  EXPECT_EQ(ServerOf({"--name=a:1"}), "localhost:50051");
}

TEST(Flags, TheServerStandsAnywhereAmongThem) {
  const std::string server = "storms.example.org:50051";
  EXPECT_EQ(ServerOf({server}), server);
  EXPECT_EQ(ServerOf({"--name", "Wall", server}), server);
  EXPECT_EQ(ServerOf({server, "--name", "Wall"}), server);
  EXPECT_EQ(ServerOf({"--kiosk", server, "--views", "a.json"}), server);
  EXPECT_EQ(ServerOf({"--views", "a.json", "b.json", "--kiosk", server}), server);
  EXPECT_EQ(ServerOf({"--tls-ca=ca.pem", server}), server);
  EXPECT_EQ(ServerOf({"[::1]:50051"}), "[::1]:50051");
}

TEST(Flags, WhatIsWrongEndsTheProgramAsItDoesTheServers) {
  constexpr int kUsage = 64;
  EXPECT_EQ(Parse({"--scale", "9"}).exit_status, kUsage);
  EXPECT_EQ(Parse({"--nothing"}).exit_status, kUsage);
  EXPECT_EQ(Parse({"--help"}).exit_status, 0);
  EXPECT_FALSE(Parse({"--help"}).flags.has_value());
}

}  // namespace
}  // namespace thunderhead::desktop
