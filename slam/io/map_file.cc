#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

#include "nn/base/checksummed_file.h"
#include "nn/base/hdf5_handle.h"
#include "slam/io/atomic_file.h"
#include "slam/io/hdf5_table.h"
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
    WriteHdf5Table(file.get(), "width", std::vector<int32_t>{stored.width}, 1);
    const Rigid3& world = stored.file_world_from_map;
    std::vector<double> pose = {world.translation.x(), world.translation.y(),
                                world.translation.z()};
    pose.insert(pose.end(), world.rotation.coeffs().begin(), world.rotation.coeffs().end());
    WriteHdf5Table(file.get(), "file_world_from_map", pose, 7);
    std::vector<double> ground;  // its normal and the camera's height over it
    if (stored.ground) {
      const Eigen::Vector3d& up = stored.ground->up;
      ground = {up.x(), up.y(), up.z(), stored.ground->camera_height};
    }
    WriteHdf5Table(file.get(), "ground", ground, 4);
    WriteHdf5Columns(file.get(), ToArrays(stored.map));
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
    const auto read = [&]<typename T>(T, const char* name, int columns) {
      return ReadHdf5Table<T>(file.get(), name, columns, kKind.name, bytes.size());
    };
    const int width = OnlyWidth(read(int32_t{}, "width", 1));
    const Rigid3 world = WorldOf(read(double{}, "file_world_from_map", 7));
    const std::optional<KnownGround> ground = GroundOf(read(double{}, "ground", 4));
    return {width, world, ground,
            FromArrays(ReadHdf5Columns<MapArrays>(file.get(), kKind.name, bytes.size()))};
  } catch (const UserError& reason) {
    throw UserError(path.string() + ": " + reason.what());
  }
}

}  // namespace orb360
