#include "tests/fuzz/foreign_storage.h"

#include <hdf5.h>

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace thunderhead::testing {
namespace {

hid_t FixedText(std::size_t size) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, size);
  return type;
}

// Returns a compound of a number and a text, nested as often as `depth` says.
hid_t Compound(std::size_t depth) {
  const hid_t inner = depth == 0 ? H5Tcopy(H5T_NATIVE_FLOAT) : Compound(depth - 1);
  const std::size_t size = H5Tget_size(inner);
  const hid_t type = H5Tcreate(H5T_COMPOUND, size + 4);
  H5Tinsert(type, "a", 0, inner);
  H5Tinsert(type, "b", size, FixedText(4));
  return type;
}

// Returns a float type with fields of any width at any position.
hid_t OddFloat(Dice& dice) {
  const hid_t type = H5Tcopy(H5T_IEEE_F64LE);
  const std::size_t exponent = 1 + dice.Below(20);
  const std::size_t mantissa = 1 + dice.Below(40);
  H5Tset_fields(type, exponent + mantissa, mantissa, exponent, 0, mantissa);
  H5Tset_ebias(type, dice.Below(2000));
  H5Tset_precision(type, 1 + exponent + mantissa);
  return type;
}

hid_t OddInteger(Dice& dice) {
  const hid_t type = H5Tcopy(dice.OneIn(2) ? H5T_STD_I64BE : H5T_STD_U32LE);
  H5Tset_precision(type, 1 + dice.Below(30));
  H5Tset_offset(type, dice.Below(3));
  return type;
}

hid_t Enumeration() {
  const hid_t type = H5Tenum_create(H5T_NATIVE_INT);
  const int zero = 0;
  H5Tenum_insert(type, "A", &zero);
  return type;
}

hid_t OddType(Dice& dice) {
  switch (dice.Below(18)) {
    case 0:
      return FixedText(1 + dice.Below(9));
    case 1:
      return FixedText(70'000);
    case 2:
      return FixedText(H5T_VARIABLE);
    case 3:
      return H5T_NATIVE_LDOUBLE;
    case 4:
      return H5T_STD_I8LE;
    case 5:
      return H5T_STD_I64BE;
    case 6:
      return H5T_NATIVE_UINT64;
    case 7:
      return H5T_IEEE_F32BE;
    case 8:
      return OddFloat(dice);
    case 9:
      return OddInteger(dice);
    case 10:
      return Compound(dice.Below(4));
    case 11:
      return Enumeration();
    case 12: {
      const hsize_t lengths[] = {1 + dice.Below(5), 2};
      return H5Tarray_create2(H5T_NATIVE_FLOAT, 1 + static_cast<unsigned>(dice.Below(2)), lengths);
    }
    case 13: {
      const hid_t type = H5Tcreate(H5T_OPAQUE, 1 + dice.Below(300));
      H5Tset_tag(type, "opaque");
      return type;
    }
    case 14:
      return H5Tvlen_create(dice.OneIn(2) ? H5T_NATIVE_FLOAT : Compound(1));
    case 15:
      return H5T_STD_REF_OBJ;
    case 16:
      return H5T_STD_B32LE;
    default:
      return dice.OneIn(2) ? H5T_IEEE_F64LE : H5T_NATIVE_FLOAT;
  }
}

hid_t OddSpace(Dice& dice, hid_t usual) {
  if (dice.OneIn(2)) return usual;
  if (dice.OneIn(8)) return H5Screate(dice.OneIn(2) ? H5S_NULL : H5S_SCALAR);
  // A long dataspace is rare, because reading much data takes long.
  constexpr std::array<hsize_t, 6> kLengths = {0, 1, 2, 4, 8, 100};
  const int rank = 1 + static_cast<int>(dice.OneIn(8) ? dice.Below(H5S_MAX_RANK) : dice.Below(5));
  std::vector<hsize_t> lengths(static_cast<std::size_t>(rank), 1);
  std::vector<hsize_t> most(lengths.size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (i < 6) lengths[i] = dice.OneIn(40) ? hsize_t{1} << 40 : dice.Of(kLengths);
    most[i] = dice.OneIn(3) ? H5S_UNLIMITED : lengths[i];
  }
  return H5Screate_simple(rank, lengths.data(), most.data());
}

// Stores values in other files. These files are all next to the file itself, and no value is
// written to them, because HDF5 would overwrite any file that this user may write.
void PlaceElsewhere(Dice& dice, hid_t creation, hid_t space, const std::string& path) {
  const std::string name = path + (dice.OneIn(2) ? "" : ".elsewhere");
  if (dice.OneIn(2)) {
    H5Pset_external(creation, name.c_str(), 0, dice.OneIn(2) ? H5F_UNLIMITED : 4096);
  } else {
    H5Pset_virtual(creation, space, dice.OneIn(2) ? "." : name.c_str(), "QCLOUD", space);
  }
}

// Returns whether the values of a dataset with these properties are in its own file.
bool IsOwn(hid_t creation) {
  return H5Pget_external_count(creation) == 0 && H5Pget_layout(creation) != H5D_VIRTUAL;
}

void AddFilters(Dice& dice, hid_t creation) {
  for (std::size_t filters = 1 + dice.Below(4); filters > 0; --filters) {
    switch (dice.Below(8)) {
      case 0:
        H5Pset_deflate(creation, static_cast<unsigned>(dice.Below(10)));
        break;
      case 1:
        H5Pset_shuffle(creation);
        break;
      case 2:
        H5Pset_fletcher32(creation);
        break;
      case 3:
        H5Pset_nbit(creation);
        break;
      case 4:
        H5Pset_scaleoffset(creation, dice.OneIn(2) ? H5Z_SO_INT : H5Z_SO_FLOAT_DSCALE,
                           static_cast<int>(dice.Below(40)));
        break;
      case 5:
        H5Pset_szip(creation, H5_SZIP_NN_OPTION_MASK, 8);
        break;
      default: {
        // These filters are not installed. HDF5 writes them only as optional filters.
        constexpr std::array kIds = {307, 32'000, 32'015, 65'535};
        const std::array<unsigned, 3> values = {0, 1, 0xffffffff};
        H5Pset_filter(creation, dice.Of(kIds), H5Z_FLAG_OPTIONAL, dice.Below(4), values.data());
      }
    }
  }
}

hid_t OddLayout(Dice& dice, hid_t type, hid_t space, const std::string& path) {
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const int rank = H5Sget_simple_extent_ndims(space);
  switch (dice.Below(6)) {
    case 0:
      H5Pset_layout(creation, H5D_COMPACT);
      break;
    case 1:
      H5Pset_layout(creation, H5D_CONTIGUOUS);
      break;
    case 2:
      PlaceElsewhere(dice, creation, space, path);
      break;
    default: {
      constexpr std::array<hsize_t, 6> kLengths = {1, 2, 3, 8, 1000, 1 << 20};
      std::vector<hsize_t> chunk(static_cast<std::size_t>(rank > 0 ? rank : 1));
      for (hsize_t& length : chunk) length = dice.OneIn(3) ? dice.Of(kLengths) : 1;
      H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
      if (dice.OneIn(2)) AddFilters(dice, creation);
    }
  }
  if (dice.OneIn(4)) {
    constexpr std::array kFills = {0.0, std::numeric_limits<double>::quiet_NaN(), 1e300, -1.0};
    const double fill = dice.Of(kFills);
    if (IsOwn(creation) && H5Tget_class(type) == H5T_FLOAT)
      H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &fill);
  }
  constexpr std::array kTimes = {H5D_FILL_TIME_ALLOC, H5D_FILL_TIME_NEVER, H5D_FILL_TIME_IFSET};
  if (dice.OneIn(4) && IsOwn(creation)) H5Pset_fill_time(creation, dice.Of(kTimes));
  return creation;
}

// Copies the attributes of a dataset. netCDF-4 stores in them which dimensions a variable has.
void CopyAttributes(hid_t from, hid_t to) {
  H5Aiterate2(
      from, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr,
      [](hid_t object, const char* name, const H5A_info_t*, void* target) {
        const hid_t old = H5Aopen(object, name, H5P_DEFAULT);
        const hid_t type = H5Aget_type(old);
        const hid_t space = H5Aget_space(old);
        const hssize_t count = H5Sget_simple_extent_npoints(space);
        std::vector<char> values(H5Tget_size(type) *
                                 static_cast<std::size_t>(count > 0 ? count : 1));
        H5Aread(old, type, values.data());
        const hid_t copy =
            H5Acreate2(*static_cast<hid_t*>(target), name, type, space, H5P_DEFAULT, H5P_DEFAULT);
        H5Awrite(copy, type, values.data());
        H5Aclose(copy);
        H5Aclose(old);
        return herr_t{0};
      },
      &to);
}

void ReplaceVariable(Dice& dice, hid_t file, const std::string& name, const std::string& path) {
  const hid_t old = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  if (old < 0) return;
  const hid_t space = OddSpace(dice, H5Dget_space(old));
  const hid_t type = dice.OneIn(4) ? H5Dget_type(old) : OddType(dice);
  const hid_t creation = OddLayout(dice, type, space, path);
  const hid_t made = H5Dcreate2(file, "made", type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  if (made < 0) return;
  if (!dice.OneIn(4)) CopyAttributes(old, made);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (IsOwn(creation) && count > 0 && count < 10'000 && !dice.OneIn(3)) {
    const std::vector<double> values(static_cast<std::size_t>(count), 1e-3);
    H5Dwrite(made, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }
  H5Dclose(made);
  H5Dclose(old);
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  H5Lmove(file, "made", file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
}

void ReplaceAttribute(Dice& dice, hid_t object) {
  constexpr std::array kNames = {
      "units",          "scale_factor", "add_offset", "_FillValue",    "missing_value",
      "valid_range",    "DX",           "TITLE",      "MP_PHYSICS",    "standard_name",
      "DIMENSION_LIST", "CLASS",        "NAME",       "_Netcdf4Dimid", "_Netcdf4Coordinates",
      "_NCProperties",  "_nc3_strict",  "axis",       "bounds",        "Conventions"};
  const char* const name = dice.Of(kNames);
  H5Adelete(object, name);
  constexpr std::array<hsize_t, 4> kLengths = {0, 1, 3, 1000};
  const hsize_t length = dice.Of(kLengths);
  const hid_t space = dice.OneIn(6)   ? H5Screate(H5S_NULL)
                      : dice.OneIn(3) ? H5Screate(H5S_SCALAR)
                                      : H5Screate_simple(1, &length, nullptr);
  const hid_t attribute = H5Acreate2(object, name, OddType(dice), space, H5P_DEFAULT, H5P_DEFAULT);
  // Only types without pointers are filled. Attributes of other types stay empty.
  const hid_t type = attribute < 0 ? -1 : H5Aget_type(attribute);
  const H5T_class_t kind = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
  if ((kind == H5T_FLOAT || kind == H5T_INTEGER || kind == H5T_OPAQUE ||
       (kind == H5T_STRING && H5Tis_variable_str(type) == 0)) &&
      !dice.OneIn(4)) {
    const std::vector<char> values(H5Tget_size(type) * 1000, 'm');
    H5Awrite(attribute, type, values.data());
  }
  if (attribute >= 0) H5Aclose(attribute);
}

void AddLink(Dice& dice, hid_t file, const std::string& variable, const std::string& path) {
  switch (dice.Below(5)) {
    case 0:
      H5Lcreate_external((path + ".elsewhere").c_str(), "/", file, "link", H5P_DEFAULT,
                         H5P_DEFAULT);
      break;
    case 1:
      H5Ldelete(file, variable.c_str(), H5P_DEFAULT);
      H5Lcreate_soft(variable.c_str(), file, variable.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      break;
    case 2:
      H5Lcreate_hard(file, "/", file, "root", H5P_DEFAULT, H5P_DEFAULT);
      break;
    case 3:
      H5Lcreate_hard(file, variable.c_str(), file, "twin", H5P_DEFAULT, H5P_DEFAULT);
      break;
    default:
      H5Tcommit2(file, "named", OddType(dice), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  }
}

std::vector<std::string> NamesIn(hid_t file) {
  std::vector<std::string> names;
  H5Literate(
      file, H5_INDEX_NAME, H5_ITER_INC, nullptr,
      [](hid_t, const char* name, const H5L_info_t*, void* data) {
        static_cast<std::vector<std::string>*>(data)->emplace_back(name);
        return herr_t{0};
      },
      &names);
  return names;
}

}  // namespace

void ChangeStorage(Dice& dice, const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const std::vector<std::string> names = NamesIn(file);
  for (std::size_t changes = 1 + dice.Below(3); changes > 0 && !names.empty(); --changes) {
    const std::string& name = names[dice.Below(names.size())];
    switch (dice.Below(6)) {
      case 0: {
        const hid_t object = dice.OneIn(4) ? H5Oopen(file, "/", H5P_DEFAULT)
                                           : H5Oopen(file, name.c_str(), H5P_DEFAULT);
        ReplaceAttribute(dice, object);
        H5Oclose(object);
        break;
      }
      case 1:
        AddLink(dice, file, name, path);
        break;
      default:
        ReplaceVariable(dice, file, name, path);
    }
  }
  H5Fclose(file);
}

}  // namespace thunderhead::testing
