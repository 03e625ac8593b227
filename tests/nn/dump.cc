#include "tests/nn/dump.h"

#include <cstddef>
#include <utility>

#include <hdf5.h>
#include <nlohmann/json.hpp>

#include "nn/base/hdf5_handle.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

Hdf5Handle Open(hid_t file, const char* name) {
  Hdf5Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  ORB360_CHECK(set.is_valid(), name);
  return set;
}

std::string ReadText(hid_t file, const char* name) {
  const Hdf5Handle set = Open(file, name);
  const Hdf5Handle type(H5Dget_type(set.get()), H5Tclose);
  std::string text(H5Tget_size(type.get()), '\0');
  ORB360_CHECK(H5Dread(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) >= 0);
  return text;
}

std::vector<float> ReadFloats(hid_t file, const char* name) {
  const Hdf5Handle set = Open(file, name);
  const Hdf5Handle space(H5Dget_space(set.get()), H5Sclose);
  std::vector<float> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())));
  ORB360_CHECK(H5Dread(set.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >=
               0);
  return values;
}

}  // namespace

std::map<std::string, Dump> ReadDumps(const std::filesystem::path& path) {
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  ORB360_CHECK(file.is_valid(), path);
  const nlohmann::json index = nlohmann::json::parse(ReadText(file.get(), "tensors/index"));
  const std::vector<float> values = ReadFloats(file.get(), "tensors/values");
  std::map<std::string, Dump> dumps;
  auto begin = values.begin();
  for (const nlohmann::json& entry : index) {
    const nlohmann::json& sizes = entry.at("shape");
    const Shape shape{sizes.at(0), sizes.at(1), sizes.at(2)};
    const auto end = begin + std::ptrdiff_t{shape.channels} * shape.height * shape.width;
    ORB360_CHECK(end <= values.end(), path);
    dumps[entry.at("case")][entry.at("name")] = {shape, {begin, end}};
    begin = end;
  }
  ORB360_CHECK(begin == values.end(), path);
  return dumps;
}

}  // namespace orb360::nn
