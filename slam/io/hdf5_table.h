#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <hdf5.h>

#include "nn/base/checksummed_file.h"
#include "nn/base/hdf5_handle.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

inline hid_t Hdf5TypeOf(float) { return H5T_IEEE_F32LE; }
inline hid_t Hdf5TypeOf(double) { return H5T_IEEE_F64LE; }
inline hid_t Hdf5TypeOf(uint8_t) { return H5T_STD_U8LE; }
inline hid_t Hdf5TypeOf(int32_t) { return H5T_STD_I32LE; }
inline hid_t Hdf5TypeOf(int64_t) { return H5T_STD_I64LE; }
inline hid_t Hdf5TypeOf(uint64_t) { return H5T_STD_U64LE; }

/// Writes `values` as a little-endian dataset of rows x `width`. The same values give the same
/// bytes.
template <typename T>
void WriteHdf5Table(hid_t file, const char* name, const std::vector<T>& values, int width) {
  const std::array<hsize_t, 2> size = {values.size() / static_cast<size_t>(width),
                                       static_cast<hsize_t>(width)};
  const Hdf5Handle space(H5Screate_simple(2, size.data(), nullptr), H5Sclose);
  const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);  // A time of writing would change the bytes.
  const Hdf5Handle set(H5Dcreate2(file, name, Hdf5TypeOf(T{}), space.get(), H5P_DEFAULT,
                                  creation.get(), H5P_DEFAULT),
                       H5Dclose);
  ORB360_CHECK(set.is_valid(), name);
  ORB360_CHECK(values.empty() || H5Dwrite(set.get(), Hdf5TypeOf(T{}), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                          values.data()) >= 0,
               name);
}

/// Reads such a dataset. Throws UserError, which says that the file holds no `kind`, for a dataset
/// that is missing, of another type or of another width. `file_bytes` is the size of the whole
/// file: a dataset that claims to be larger is refused before memory is taken.
template <typename T>
std::vector<T> ReadHdf5Table(hid_t file, const char* name, int width, std::string_view kind,
                             std::uintmax_t file_bytes) {
  const Hdf5Handle set = OpenOwnDataset(file, name);
  const Hdf5Handle type(H5Dget_type(set.get()), H5Tclose);
  const Hdf5Handle space(H5Dget_space(set.get()), H5Sclose);
  std::array<hsize_t, 2> size{};
  const bool is_table = H5Sget_simple_extent_ndims(space.get()) == 2 &&
                        H5Sget_simple_extent_dims(space.get(), size.data(), nullptr) == 2 &&
                        size[1] == static_cast<hsize_t>(width) &&
                        H5Tequal(type.get(), Hdf5TypeOf(T{})) > 0;
  if (!is_table || size[0] > file_bytes / (sizeof(T) * static_cast<size_t>(width))) {
    std::string reason = "holds no ";
    reason += kind;
    reason += ": dataset ";
    reason += name;
    throw UserError(reason + " is of another type or shape");
  }
  std::vector<T> values(size[0] * static_cast<size_t>(width));
  if (!values.empty() &&
      H5Dread(set.get(), Hdf5TypeOf(T{}), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    std::string reason = "dataset ";
    reason += name;
    throw UserError(reason + " cannot be read");
  }
  return values;
}

/// Writes each column of `arrays` as a table. ForEachColumn(arrays, visit) calls visit(name,
/// column, width) for each.
template <typename Arrays>
void WriteHdf5Columns(hid_t file, const Arrays& arrays) {
  ForEachColumn(arrays, [&](const char* name, const auto& column, int width) {
    WriteHdf5Table(file, name, column, width);
  });
}

/// Reads such columns; the other arguments and errors are those of ReadHdf5Table.
template <typename Arrays>
Arrays ReadHdf5Columns(hid_t file, std::string_view kind, std::uintmax_t file_bytes) {
  Arrays arrays;
  ForEachColumn(arrays, [&](const char* name, auto& column, int width) {
    using Value = typename std::remove_reference_t<decltype(column)>::value_type;
    column = ReadHdf5Table<Value>(file, name, width, kind, file_bytes);
  });
  return arrays;
}

}  // namespace orb360
