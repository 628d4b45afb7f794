#include "netcdf/packing.h"

#include <netcdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::netcdf {
namespace {

// Models write fill values from 1e30 (a common choice) to 9.969e36 (netCDF's own). No quantity in a
// storm is that large.
constexpr double kLargestValue = 1e30;
constexpr double kLargestFill = 1e37;

constexpr double kMissingValue = std::numeric_limits<double>::quiet_NaN();

double OneNumberOr(int group, int variable, const char* name, double otherwise) {
  const std::vector<double> numbers = NumbersOf(group, variable, name);
  return numbers.size() == 1 ? numbers.front() : otherwise;
}

// Returns the value of the attribute scale_factor or add_offset, or `otherwise` if the attribute is
// absent.
absl::StatusOr<double> PackingNumber(int group, int variable, const char* name, double otherwise) {
  if (nc_inq_att(group, variable, name, nullptr, nullptr) != NC_NOERR) return otherwise;
  const std::vector<double> numbers = NumbersOf(group, variable, name);
  if (numbers.size() == 1 && std::isfinite(numbers.front())) return numbers.front();
  return absl::InvalidArgumentError(
      absl::StrCat("its attribute ", name,
                   " is not one finite number, so its values cannot be unpacked; write one finite "
                   "number there, or remove the attribute if the values are not packed"));
}

double DefaultFill(nc_type type) {
  switch (type) {
    case NC_SHORT:
      return NC_FILL_SHORT;
    case NC_INT:
      return NC_FILL_INT;
    case NC_USHORT:
      return NC_FILL_USHORT;
    case NC_UINT:
      return NC_FILL_UINT;
    // Bytes have no default fill value, and those of floating-point types exceed kLargestValue.
    default:
      return kMissingValue;
  }
}

// Returns how many different values an integer type of at most 32 bits has. The result is negative
// if the type is unsigned, and 0 for any other type.
double SignedSpan(nc_type type) {
  switch (type) {
    case NC_BYTE:
      return 0x1p8;
    case NC_UBYTE:
      return -0x1p8;
    case NC_SHORT:
      return 0x1p16;
    case NC_USHORT:
      return -0x1p16;
    case NC_INT:
      return 0x1p32;
    case NC_UINT:
      return -0x1p32;
    default:
      return 0.0;
  }
}

// Returns the attribute _Unsigned, or nothing if it is absent.
std::optional<bool> IsUnsigned(int group, int variable) {
  constexpr const char* kName = "_Unsigned";
  nc_type type;
  std::size_t length = 0;
  if (nc_inq_att(group, variable, kName, &type, &length) != NC_NOERR) return std::nullopt;
  if (type == NC_STRING && length == 1) {
    char* text = nullptr;
    if (nc_get_att_string(group, variable, kName, &text) != NC_NOERR) return std::nullopt;
    const char first = text != nullptr ? text[0] : '\0';
    nc_free_string(1, &text);
    return first == 't' || first == 'T' || first == '1';
  }
  if (type != NC_CHAR) return OneNumberOr(group, variable, kName, 0.0) != 0.0;
  constexpr std::size_t kLongest = 16;
  std::array<char, kLongest> text{};
  if (length > kLongest || nc_get_att_text(group, variable, kName, text.data()) != NC_NOERR) {
    return std::nullopt;
  }
  return text[0] == 't' || text[0] == 'T' || text[0] == '1';
}

double Meant(double stored, const Packing& packing) {
  if (packing.wrap > 0.0 && stored < 0.0) return stored + packing.wrap;
  const bool upper_half = packing.wrap < 0.0 && stored >= -0.5 * packing.wrap;
  return upper_half ? stored + packing.wrap : stored;
}

// Returns the numbers of an attribute of the valid range as packed values. If the attribute has
// floating-point numbers and the variable has integers, the attribute holds unpacked values, which
// this function packs.
std::vector<double> PackedLimits(int group, int variable, const char* name, bool integers,
                                 const Packing& packing) {
  std::vector<double> limits = NumbersOf(group, variable, name);
  nc_type type = NC_NAT;
  nc_inq_atttype(group, variable, name, &type);
  const bool unpacked = integers && (type == NC_FLOAT || type == NC_DOUBLE) &&
                        (packing.scale != 1.0 || packing.offset != 0.0);
  for (double& limit : limits) {
    limit = unpacked ? (limit - packing.offset) / packing.scale : Meant(limit, packing);
  }
  return limits;
}

// Returns an error if an attribute of the valid range is NaN, so that it limits nothing.
absl::Status CheckLimits(int group, int variable) {
  for (const char* name : {"valid_min", "valid_max", "valid_range"}) {
    const std::vector<double> limits = NumbersOf(group, variable, name);
    if (std::ranges::none_of(limits, [](double limit) { return std::isnan(limit); })) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("its attribute ", name,
                     " is not a number (NaN), so it does not say which values are valid; write a "
                     "number there, or remove the attribute"));
  }
  return absl::OkStatus();
}

void ReadValidRange(int group, int variable, bool integers, Packing& packing) {
  double lowest = packing.lowest;
  double highest = packing.highest;
  const auto limits = [&](const char* name) {
    return PackedLimits(group, variable, name, integers, packing);
  };
  if (const auto least = limits("valid_min"); least.size() == 1) lowest = least[0];
  if (const auto most = limits("valid_max"); most.size() == 1) highest = most[0];
  if (const auto range = limits("valid_range"); range.size() == 2) {
    lowest = std::min(range[0], range[1]);
    highest = std::max(range[0], range[1]);
  }
  // A range without any value in it is a mistake, and is not used.
  if (!(lowest <= highest)) return;
  packing.lowest = lowest;
  packing.highest = highest;
}

bool IsMissing(double packed, const Packing& packing) {
  return packed == packing.fill || packed < packing.lowest || packed > packing.highest ||
         std::ranges::find(packing.missing, packed) != packing.missing.end();
}

float FlushedFloat(double value) {
  const bool subnormal = std::abs(value) < std::numeric_limits<float>::min();
  return subnormal ? 0.0F : static_cast<float>(value);
}

// Takes the values of a variable that are too large for any quantity and that the file does not
// declare as missing. Distinguishes undeclared codes for missing values from impossible values.
class HugeValues {
 public:
  void Take(double value) {
    const double size = std::abs(value);
    const bool is_default = static_cast<float>(size) == NC_FILL_FLOAT || size == NC_FILL_DOUBLE;
    if (is_default || impossible_.has_value()) return;
    if (!(size <= kLargestFill) || (fill_.has_value() && *fill_ != value)) {
      impossible_ = value;
    } else {
      fill_ = value;
    }
  }
  void TakeImpossible(double value) {
    if (!impossible_.has_value()) impossible_ = value;
  }
  std::optional<double> Impossible() const { return impossible_; }

 private:
  std::optional<double> fill_;  // the undeclared code for missing values
  std::optional<double> impossible_;
};

}  // namespace

std::vector<double> NumbersOf(int group, int variable, const char* attribute) {
  constexpr std::size_t kMost = 1 << 20;
  nc_type type;
  std::size_t length = 0;
  if (nc_inq_att(group, variable, attribute, &type, &length) != NC_NOERR || length > kMost ||
      type == NC_CHAR || type == NC_STRING || type > NC_MAX_ATOMIC_TYPE) {
    return {};
  }
  std::vector<double> values(length);
  const bool read = nc_get_att_double(group, variable, attribute, values.data()) == NC_NOERR;
  return read ? values : std::vector<double>();
}

absl::StatusOr<Packing> PackingOf(int group, int variable) {
  Packing packing;
  nc_type type = NC_FLOAT;
  nc_inq_vartype(group, variable, &type);
  packing.floats = type == NC_FLOAT;
  THUNDERHEAD_ASSIGN_OR_RETURN(packing.scale, PackingNumber(group, variable, "scale_factor", 1.0));
  THUNDERHEAD_ASSIGN_OR_RETURN(packing.offset, PackingNumber(group, variable, "add_offset", 0.0));
  const double span = SignedSpan(type);
  const std::optional<bool> is_unsigned = IsUnsigned(group, variable);
  // The attribute _Unsigned has an effect only if the type has the other signedness.
  if (is_unsigned.has_value() && *is_unsigned == (span > 0.0)) packing.wrap = span;
  packing.fill = Meant(OneNumberOr(group, variable, "_FillValue", DefaultFill(type)), packing);
  packing.missing = NumbersOf(group, variable, "missing_value");
  for (double& code : packing.missing) code = Meant(code, packing);
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(group, variable));
  ReadValidRange(group, variable, span != 0.0, packing);
  return packing;
}

double Unpacked(double stored, const Packing& packing) {
  const double packed = Meant(stored, packing);
  if (IsMissing(packed, packing)) return kMissingValue;
  const double value = packed * packing.scale + packing.offset;
  // The comparison fails for NaN, so NaN becomes kMissingValue too.
  return std::abs(value) < kLargestValue ? value : kMissingValue;
}

std::optional<double> Unpack(absl::Span<const double> packed, const Packing& packing,
                             absl::Span<float> values) {
  HugeValues huge;
  for (std::size_t i = 0; i < packed.size(); ++i) {
    const double value = Unpacked(packed[i], packing);
    values[i] = FlushedFloat(value);
    if (!std::isnan(value)) continue;
    const double meant = Meant(packed[i], packing);
    if (std::isnan(meant) || IsMissing(meant, packing)) continue;
    if (std::abs(meant) >= kLargestValue) {
      huge.Take(meant);
    } else {
      huge.TakeImpossible(meant * packing.scale + packing.offset);
    }
  }
  return huge.Impossible();
}

std::optional<double> CleanPlainFloats(const Packing& packing, std::vector<float>& values) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto fill = static_cast<float>(packing.fill);
  const auto lowest = static_cast<float>(packing.lowest);
  const auto highest = static_cast<float>(packing.highest);
  for (const double missing : packing.missing) {
    std::ranges::replace(values, static_cast<float>(missing), kNan);
  }
  std::size_t huge_values = 0;
  for (float& value : values) {
    const float size = std::abs(value);
    // The comparisons with the limits fail for NaN, so NaN counts as missing.
    const bool present = value != fill && value >= lowest && value <= highest;
    huge_values += present && size >= static_cast<float>(kLargestValue) ? 1 : 0;
    const float flushed = size < std::numeric_limits<float>::min() ? 0.0F : value;
    value = present ? flushed : kNan;
  }
  HugeValues huge;
  if (huge_values == 0) return huge.Impossible();
  for (float& value : values) {
    if (!(std::abs(value) >= static_cast<float>(kLargestValue))) continue;
    huge.Take(value);
    value = kNan;
  }
  return huge.Impossible();
}

}  // namespace thunderhead::netcdf
