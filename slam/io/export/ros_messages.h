#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "slam/io/positions/projection.h"
#include <orb360/slam/geometry/rigid3.h>

namespace orb360 {

// Messages of ROS 2 in its serialization (CdrWriter). Frames follow REP 103 and REP 105, lengths
// are metres. Stamps are nanoseconds from 0 to kMaxRosTime; others throw ContractError.

/// Largest stamp: its seconds have 31 bits.
inline constexpr std::int64_t kMaxRosTime = ((std::int64_t{1} << 31) - 1) * 1'000'000'000;

/// std_msgs/msg/Header.
struct RosHeader {
  std::int64_t stamp = 0;
  std::string_view frame;
};

/// A pose of a frame in that of the header, or the transform to that frame from the child.
struct RosPose {
  RosHeader header;
  std::string_view child;
  Rigid3 header_from_child;
};

/// A point of sensor_msgs/msg/PointCloud2.
struct RosPoint {
  Eigen::Vector3f position;
  std::array<std::uint8_t, 3> rgb{};
};

/// A position of sensor_msgs/msg/NavSatFix, with approximate standard deviations.
struct RosFix {
  RosHeader header;
  GeodeticPoint point;          ///< The height is not a number where that over the ellipsoid is
                                ///< not known.
  double horizontal_sigma = 0;  ///< In each direction, metres.
  double vertical_sigma = 0;    ///< Metres; infinite where the height is not known.
};

/// tf2_msgs/msg/TFMessage.
std::string RosTransforms(std::span<const RosPose> poses);
/// geometry_msgs/msg/PoseStamped.
std::string RosPoseStamped(const RosPose& pose);
/// nav_msgs/msg/Path.
std::string RosPath(const RosHeader& header, std::span<const RosPose> poses);
/// sensor_msgs/msg/CompressedImage. `format`: "jpeg" or "png".
std::string RosCompressedImage(const RosHeader& header, std::string_view format,
                               std::string_view data);
/// sensor_msgs/msg/PointCloud2 of the fields x, y, z and rgb, as the Point Cloud Library has them:
/// the colour is the bits 0x00RRGGBB of a float.
std::string RosPointCloud(const RosHeader& header, std::span<const RosPoint> points);
/// sensor_msgs/msg/NavSatFix.
std::string RosNavSatFix(const RosFix& fix);

}  // namespace orb360
