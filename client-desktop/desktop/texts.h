// Numbers, times and views as people read them; the same words as the page's.
#pragma once

#include <string>

#include "thunderhead/v1/frame.pb.h"
#include "thunderhead/v1/scene.pb.h"
#include "thunderhead/v1/storm.pb.h"
#include "thunderhead_client/limits.h"
#include "thunderhead_client/pose.h"

namespace thunderhead::desktop {

// The unit to show a number in: multiply a value in the schema's unit by `factor`.
struct DisplayUnit {
  double factor = 1.0;
  std::string symbol;  // empty for a pure number
};
DisplayUnit DisplayUnitOf(const client::Limits& limits);

// Three significant digits, without an exponent where the number is readable without.
std::string FormatNumber(double value);
std::string FormatQuantity(double value, const client::Limits& limits);
std::string FormatPercent(double share);        // "8.4 %" of 0.084
std::string FormatLength(double length_m);      // "8.4 km"
std::string FormatBytes(double bytes);          // "1.2 MB"
std::string FormatBitRate(double bytes_per_s);  // "1.4 Mbit/s"
// "2013-05-20 20:00 UTC"; of idealised runs, which begin in year 1, "day 1, 00:20".
std::string FormatValidTime(const v1::StormTime& time);
std::string FormatElapsed(double elapsed_s);  // "+1 h 20 min"
// "run 2013-05-20 06:00Z"; of an idealised run, which has no date, "run 06:00Z"; empty where the
// files do not tell.
std::string NameOfRun(const v1::StormDescription& storm);
// From the run's start to one of the storm's times; from the first time where the start is not
// known.
double LeadSeconds(const v1::StormDescription& storm, const v1::StormTime& time);
std::string CompassPoint(double azimuth_deg);  // "NNE"
std::string DescribePose(const client::Pose& pose);
std::string DescribeSun(const v1::Sun& sun);
std::string NameOf(v1::Hydrometeor hydrometeor);  // "Cloud"
std::string NameOf(v1::Preset preset);            // "Uniform phase, low albedo"
// The field is extinction already: the sizes of its particles have no effect.
bool IsExtinction(const v1::FieldDescription& field);
// "up to 8.2 g/kg", of mass by volume in g/m³, of extinction in /km.
std::string DescribeAmount(const v1::FieldDescription& field);
// "measured: 8.1 to 9.4 %", or where the error comes from until it is.
std::string ErrorSource(const v1::AccuracyReport& report);
// "Measured error 8.7 % (measured: 8.1 to 9.4 %, 2 % too dark on the whole)"; before it is
// measured, the parts of the table's.
std::string DescribeError(const v1::AccuracyReport& report);

}  // namespace thunderhead::desktop
