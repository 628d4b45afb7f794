// A small model run with one file per ten minutes of model time. Its pictures take little time to
// draw.
#pragma once

#include <string>

namespace thunderhead::testing {

// Returns the path in `folder` of the file with this time; `time` counts from 0.
std::string RunFile(const std::string& folder, int time);
// Returns the valid time in the form that names of products contain, such as "20130520_2010".
std::string RunTime(int time);

// Writes the file of this time. The cloud's density is multiplied by `density`. If `torn` is true,
// the file can be opened but does not contain the cloud yet, as while a model writes it.
void WriteRunFile(const std::string& folder, int time, double density = 1.0, bool torn = false);

// Sets the file's modification time a minute into the future, so that the file counts as still
// being written, however slow the test is.
void KeepFresh(const std::string& file);

// Sets the file's modification time an hour into the past, so that the file does not count as still
// being written.
void LeaveAlone(const std::string& file);

}  // namespace thunderhead::testing
