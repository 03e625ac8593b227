#include "apps/town/image/cube.h"

#include <cmath>
#include <numbers>

namespace orb360::town {

Eigen::Quaterniond CameraFromFace(int face) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const auto turn = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
  };
  switch (face) {
    case kRight:
      return turn(-kQuarter, Eigen::Vector3d::UnitZ());
    case kBack:
      return turn(2 * kQuarter, Eigen::Vector3d::UnitZ());
    case kLeft:
      return turn(kQuarter, Eigen::Vector3d::UnitZ());
    case kUp:
      return turn(kQuarter, Eigen::Vector3d::UnitY());
    case kDown:
      return turn(-kQuarter, Eigen::Vector3d::UnitY());
    default:
      return Eigen::Quaterniond::Identity();
  }
}

CubePoint MeetCube(const Eigen::Vector3d& d) {
  const double ax = std::abs(d.x());
  const double ay = std::abs(d.y());
  const double az = std::abs(d.z());
  if (ax >= ay && ax >= az) {
    // For a face that is turned by half a turn, right and left are exchanged.
    return d.x() < 0 ? CubePoint{kFront, d.y() / ax, d.z() / ax}
                     : CubePoint{kBack, -d.y() / ax, d.z() / ax};
  }
  if (ay >= az) {
    return d.y() > 0 ? CubePoint{kRight, d.x() / ay, d.z() / ay}
                     : CubePoint{kLeft, -d.x() / ay, d.z() / ay};
  }
  return d.z() > 0 ? CubePoint{kUp, d.y() / az, d.x() / az}
                   : CubePoint{kDown, d.y() / az, -d.x() / az};
}

}  // namespace orb360::town
