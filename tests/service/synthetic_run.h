// A small model run with one file every ten minutes, which draws in a moment.
#pragma once

#include <string>

namespace thunderhead::testing {

// Returns the path of the file of one time, counted from 0, in `folder`.
std::string RunFile(const std::string& folder, int time);
// Returns the valid time as in names of products: "20130520_2010".
std::string RunTime(int time);

// Writes the file, with `density` times the cloud. A `torn` file opens, but has no cloud yet.
void WriteRunFile(const std::string& folder, int time, double density = 1.0, bool torn = false);

// Dates the file a minute ahead, so that it counts as being written, however slowly a test begins.
void KeepFresh(const std::string& file);

// Dates the file back by an hour, so that it does not count as being written.
void LeaveAlone(const std::string& file);

}  // namespace thunderhead::testing
