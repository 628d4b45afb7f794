// Formats numbers, times and views for people. The texts are the same as the page's.
#pragma once

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

// Formats a number with three significant digits. Uses no exponent if the number is readable
// without it.
std::string FormatNumber(double value);
std::string FormatQuantity(double value, const client::Limits& limits);
std::string FormatPercent(double share);        // "8.4 %" for 0.084
std::string FormatLength(double length_m);      // "8.4 km"
std::string FormatBytes(double bytes);          // "1.2 MB"
std::string FormatBitRate(double bytes_per_s);  // "1.4 Mbit/s"
// Returns a text like "2013-05-20 20:00 UTC". For idealised runs, which begin in year 1, it is like
// "day 1, 00:20".
std::string FormatValidTime(const v1::StormTime& time);
std::string FormatElapsed(double elapsed_s);  // "+1 h 20 min"
// Returns a text like "run 2013-05-20 06:00Z". For an idealised run, which has no date, it is like
// "run 06:00Z". It is empty if the files do not contain the start.
std::string NameOfRun(const v1::StormDescription& storm);
// Returns the time from the run's start to one of the storm's times. If the start is unknown, it
// counts from the first time.
double LeadSeconds(const v1::StormDescription& storm, const v1::StormTime& time);
std::string CompassPoint(double azimuth_deg);  // "NNE"
std::string DescribePose(const client::Pose& pose);
std::string DescribeSun(const v1::Sun& sun);
std::string NameOf(v1::Hydrometeor hydrometeor);  // "Cloud"
std::string NameOf(v1::Preset preset);            // "Uniform phase, low albedo"
// Returns true if the field is already an extinction. The sizes of its particles then have no
// effect.
bool IsExtinction(const v1::FieldDescription& field);
// Returns a text like "up to 8.2 g/kg". Mass per volume is in g/m³, extinction in /km.
std::string DescribeAmount(const v1::FieldDescription& field);
// Returns a text like "measured: 8.1 to 9.4 %". Before the error is measured, it names the error's
// source instead.
std::string ErrorSource(const v1::AccuracyReport& report);
// Returns a text like "Measured error 8.7 % (measured: 8.1 to 9.4 %, 2 % too dark on the whole)".
// Before the error is measured, it lists the parts of the table's error.
std::string DescribeError(const v1::AccuracyReport& report);

}  // namespace thunderhead::desktop
