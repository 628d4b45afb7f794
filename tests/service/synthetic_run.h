// A small run of a model, a file each ten minutes, that draws in a moment.
#pragma once

#include <string>

namespace thunderhead::testing {

// The path of the file of one time, from 0, in `folder`.
std::string RunFile(const std::string& folder, int time);
// Its valid time as in names of products: "20130520_2010".
std::string RunTime(int time);

// Writes it, with `density` times the cloud. One that is `torn` opens, but has no cloud yet.
void WriteRunFile(const std::string& folder, int time, double density = 1.0, bool torn = false);

// Dates the file a minute ahead, so that it counts as being written however slowly a test begins.
void KeepFresh(const std::string& file);

// Dates the file back by an hour, so that nobody takes it for one that is being written.
void LeaveAlone(const std::string& file);

}  // namespace thunderhead::testing
