#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

#include "nn/base/checksummed_file.h"
#include "nn/base/hdf5_handle.h"
#include "slam/io/atomic_file.h"
#include "slam/io/map_arrays.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/map_file.h>

namespace orb360 {
namespace {

constexpr ChecksummedFormat kKind = {"ORB360MP",
                                     2,
                                     "map",
                                     "`orb360 run --map-out`",
                                     "make the map anew with this one",
                                     std::uintmax_t{1} << 36};

hid_t TypeOf(float) { return H5T_IEEE_F32LE; }
hid_t TypeOf(double) { return H5T_IEEE_F64LE; }
hid_t TypeOf(uint8_t) { return H5T_STD_U8LE; }
hid_t TypeOf(int32_t) { return H5T_STD_I32LE; }
hid_t TypeOf(int64_t) { return H5T_STD_I64LE; }
hid_t TypeOf(uint64_t) { return H5T_STD_U64LE; }

template <typename T>
void WriteColumn(hid_t file, const char* name, const std::vector<T>& column, int width) {
  const std::array<hsize_t, 2> size = {column.size() / static_cast<size_t>(width),
                                       static_cast<hsize_t>(width)};
  const Hdf5Handle space(H5Screate_simple(2, size.data(), nullptr), H5Sclose);
  const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);  // the same map gives the same bytes
  const Hdf5Handle set(
      H5Dcreate2(file, name, TypeOf(T{}), space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
      H5Dclose);
  ORB360_CHECK(set.is_valid(), name);
  ORB360_CHECK(column.empty() || H5Dwrite(set.get(), TypeOf(T{}), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                          column.data()) >= 0,
               name);
}

template <typename T>
void ReadColumn(hid_t file, const char* name, int width, std::vector<T>* column) {
  const Hdf5Handle set = OpenOwnDataset(file, name);
  const Hdf5Handle type(H5Dget_type(set.get()), H5Tclose);
  const Hdf5Handle space(H5Dget_space(set.get()), H5Sclose);
  std::array<hsize_t, 2> size{};
  const bool is_table = H5Sget_simple_extent_ndims(space.get()) == 2 &&
                        H5Sget_simple_extent_dims(space.get(), size.data(), nullptr) == 2 &&
                        size[1] == static_cast<hsize_t>(width) &&
                        H5Tequal(type.get(), TypeOf(T{})) > 0;
  // The largest number of rows that a file without compression can contain.
  constexpr hsize_t kMaxSize = (hsize_t{1} << 36) / 8;
  if (!is_table || size[0] > kMaxSize) {
    std::string reason = "holds no map: dataset ";
    reason += name;
    throw UserError(reason + " is of another type or shape");
  }
  column->resize(size[0] * static_cast<size_t>(width));
  if (!column->empty() &&
      H5Dread(set.get(), TypeOf(T{}), H5S_ALL, H5S_ALL, H5P_DEFAULT, column->data()) < 0) {
    std::string reason = "dataset ";
    reason += name;
    throw UserError(reason + " cannot be read");
  }
}

void Require(bool is_right, const char* what) {
  if (is_right) return;
  std::string reason = "holds no map: ";
  throw UserError(reason += what);
}

int OnlyWidth(const std::vector<int32_t>& width) {
  Require(width.size() == 1 && width[0] > 0, "it has no size of images");
  return width[0];
}

constexpr double kUnit = 1e-6;  // how far from 1 the length of a unit vector may be

Rigid3 WorldOf(const std::vector<double>& pose) {
  Require(pose.size() == 7, "it has no world");
  Rigid3 world{Eigen::Quaterniond(pose.data() + 3), Eigen::Vector3d(pose.data())};
  Require(world.translation.allFinite() && std::abs(world.rotation.norm() - 1.0) < kUnit,
          "its world is out of range");
  return world;
}

std::optional<KnownGround> GroundOf(const std::vector<double>& ground) {
  if (ground.empty()) return std::nullopt;
  Require(ground.size() == 4, "it has several grounds");
  const KnownGround known{Eigen::Vector3d(ground.data()), ground[3]};
  Require(std::abs(known.up.norm() - 1.0) < kUnit && known.camera_height > 0 &&
              std::isfinite(known.camera_height),
          "its ground is out of range");
  return known;
}

}  // namespace

void WriteMap(const std::filesystem::path& path, const StoredMap& stored) {
  std::string content;
  {
    const Hdf5Handle file = CreateChecksummedContent();
    WriteColumn(file.get(), "width", std::vector<int32_t>{stored.width}, 1);
    const Rigid3& world = stored.file_world_from_map;
    std::vector<double> pose = {world.translation.x(), world.translation.y(),
                                world.translation.z()};
    pose.insert(pose.end(), world.rotation.coeffs().begin(), world.rotation.coeffs().end());
    WriteColumn(file.get(), "file_world_from_map", pose, 7);
    std::vector<double> ground;  // its normal and the camera's height over it
    if (stored.ground) {
      const Eigen::Vector3d& up = stored.ground->up;
      ground = {up.x(), up.y(), up.z(), stored.ground->camera_height};
    }
    WriteColumn(file.get(), "ground", ground, 4);
    const MapArrays arrays = ToArrays(stored.map);
    ForEachColumn(arrays, [&](const char* name, const auto& column, int width) {
      WriteColumn(file.get(), name, column, width);
    });
    content = TakeContent(file);
  }
  AtomicFile file(path);
  file.Write(MakeChecksumHeader(kKind, content));
  file.Write(content);
  file.Commit();
}

StoredMap ReadMap(const std::filesystem::path& path) {
  try {
    FileBytes bytes = ReadChecksummedFile(path, kKind);
    const Hdf5Quiet quiet;
    const Hdf5Handle file = OpenChecksummedContent(&bytes);
    std::vector<int32_t> width;
    ReadColumn(file.get(), "width", 1, &width);
    std::vector<double> pose;
    ReadColumn(file.get(), "file_world_from_map", 7, &pose);
    std::vector<double> ground;
    ReadColumn(file.get(), "ground", 4, &ground);
    MapArrays arrays;
    ForEachColumn(arrays, [&](const char* name, auto& column, int columns) {
      ReadColumn(file.get(), name, columns, &column);
    });
    return {OnlyWidth(width), WorldOf(pose), GroundOf(ground), FromArrays(arrays)};
  } catch (const UserError& reason) {
    throw UserError(path.string() + ": " + reason.what());
  }
}

}  // namespace orb360
