// Formats numbers, times and views as texts for people. The web page shows the same or similar
// texts.
#pragma once

#include <cstddef>
#include <string>

#include "thunderhead/v1/frame.pb.h"
#include "thunderhead/v1/scene.pb.h"
#include "thunderhead/v1/storm.pb.h"
#include "thunderhead_client/limits.h"
#include "thunderhead_client/pose.h"

namespace thunderhead::desktop {

// The unit in which a number is shown. A value in the schema's unit is multiplied by `factor`.
struct DisplayUnit {
  double factor = 1.0;
  std::string symbol;  // empty for a pure number
};
DisplayUnit DisplayUnitOf(const client::Limits& limits);

// Formats a number with three significant digits, without trailing zeros. Numbers from 100 to a
// million are rounded to integers. Numbers from a million or below 0.0001 have an exponent.
std::string FormatNumber(double value);
std::string FormatQuantity(double value, const client::Limits& limits);
std::string FormatPercent(double share);        // "8.4 %" for 0.084
std::string FormatLength(double length_m);      // "8.4 km"
std::string FormatBytes(double bytes);          // "1.2 MB"
std::string FormatBitRate(double bytes_per_s);  // "1.4 Mbit/s"
// Returns the start of a UTF-8 text with at most `most_bytes` bytes. Does not cut a character
// apart, because protobuf accepts no string that is invalid UTF-8.
std::string CutTo(std::string text, std::size_t most_bytes);
// Returns a text like "2013-05-20 20:00 UTC". For an idealised run, which begins in year 1, the
// text is like "day 1, 00:20".
std::string FormatValidTime(const v1::StormTime& time);
std::string FormatElapsed(double elapsed_s);  // "+1 h 20 min"
// Returns a text like "run 2013-05-20 06:00Z". For an idealised run, which has no date, the text is
// like "run 06:00Z". The text is empty if the storm's files do not contain the run's start.
std::string NameOfRun(const v1::StormDescription& storm);
// Returns the seconds from the run's start to `time`. If the start is unknown, returns the seconds
// from the storm's first time.
double LeadSeconds(const v1::StormDescription& storm, const v1::StormTime& time);
std::string CompassPoint(double azimuth_deg);  // "NNE"
// DescribePose() and DescribeSun() return texts whose azimuths count from true north. The azimuths
// of `pose` and `sun` count from the grid's north. `true_north_deg` is the azimuth of true north in
// the scene.
std::string DescribePose(const client::Pose& pose, double true_north_deg);
std::string DescribeSun(const v1::Sun& sun, double true_north_deg);
std::string NameOf(v1::Hydrometeor hydrometeor);  // "Cloud"
std::string NameOf(v1::Preset preset);            // "Uniform phase, low albedo"
// Returns true if the field contains extinction instead of a mass of water or ice. Particle sizes
// then have no effect on the field.
bool IsExtinction(const v1::FieldDescription& field);
// Returns the field's maximum as a text like "up to 8.2 g/kg". A field with mass per volume is
// shown in g/m³, and an extinction in /km.
std::string DescribeAmount(const v1::FieldDescription& field);
// Returns a text like "measured: 8.1 to 9.4 %", the interval of the measured error. Before the
// error is measured, the text says that the error comes from a table.
std::string ErrorSource(const v1::AccuracyReport& report);
// Returns a text like "Measured error 8.7 % (measured: 8.1 to 9.4 %, 2 % too dark on the whole)".
// Before the error is measured, the text shows the estimate from the table and its parts.
std::string DescribeError(const v1::AccuracyReport& report);

}  // namespace thunderhead::desktop
