// Recognises variables of a CF file that hold condensed water in a form that is not shown, such as
// convective cloud. The user is told of each of them, because the storm lacks this water.
#pragma once

#include <optional>
#include <string>

#include "storm_files/cf_names.h"

namespace thunderhead::storm_files {

// Returns whether the standard name is that of an amount of condensed water in air, of any kind.
bool IsStandardNameOfWater(const std::string& standard_name);

// Returns why a variable that seems to hold condensed water is not shown, as the end of a sentence
// with "because". Returns nothing if QuantityOf or AirVariableOf recognises the variable, and for
// variables that seem to hold something else.
std::optional<std::string> WhyWaterIsNotShown(const CfDescription& variable);

}  // namespace thunderhead::storm_files
