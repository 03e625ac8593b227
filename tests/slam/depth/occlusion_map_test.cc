#include "slam/depth/occlusion_map.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/slam/depth/range_room.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

const EquirectangularCamera kCamera(256, 128);
const RangeRoom kRoom;
const Rigid3 kReference = TurnedCamera({0.1, 0.2, -0.1}, 0.3);
const Rigid3 kSource = TurnedCamera({0.9, -0.4, 0.2}, -0.5);

DepthView View(const Rigid3& camera, double confidence, const std::optional<Ball>& ball = {}) {
  return {kRoom.Render(kCamera, camera, ball, confidence), camera, 1.0, 0.01};
}

TEST(OcclusionMap, EndsRaysWhereTheSourceViewSeesSurfaces) {
  const OcclusionMap map(View(kSource, 0.99), View(kReference, 0.99));
  int num_known = 0;
  for (int row = 2; row < 128; row += 5) {
    for (int column = 2; column < 256; column += 5) {
      const float range = map.RangeAt(row, column);
      if (std::isinf(range)) continue;
      ++num_known;
      // The farthest surface of an angle of 12 pixels.
      double least = 1e9;
      double most = 0;
      for (int y = std::max(row - 8, 0); y <= std::min(row + 8, 127); ++y) {
        for (int x = column - 8; x <= column + 8; ++x) {
          const Eigen::Vector3d ray =
              kReference.rotation * kCamera.Bearing({(x + 256) % 256 + 0.5, y + 0.5});
          const double truth = kRoom.RangeOfWalls(kReference.translation, ray);
          least = std::min(least, truth);
          most = std::max(most, truth);
        }
      }
      EXPECT_GT(range, 0.99 * least) << row << ' ' << column;
      EXPECT_LT(range, 1.01 * most) << row << ' ' << column;
    }
  }
  EXPECT_GT(num_known, 1000);
}

TEST(OcclusionMap, ClaimsNothingOfWhatIsUncertain) {
  const OcclusionMap map(View(kSource, 0.9), View(kReference, 0.99));
  for (int row = 0; row < 128; ++row) EXPECT_TRUE(std::isinf(map.RangeAt(row, 2 * row)));
}

TEST(OcclusionMap, BehindTheBorderOfASurfaceRaysGoOn) {
  const Ball ball{{2.5, -1.0, 0.0}, 0.9};
  const Rigid3 before = TurnedCamera({0.4, 0.1, -0.1}, 0.2);
  const OcclusionMap map(View(before, 0.99, ball), View(kReference, 0.99));
  const auto range_towards = [&](const Eigen::Vector3d& point) {
    const Eigen::Vector2d at = kCamera.Project(kReference.Inverse() * point);
    return map.RangeAt(static_cast<int>(at.y()), static_cast<int>(at.x()));
  };
  const double distance = (ball.centre - kReference.translation).norm();
  EXPECT_LT(range_towards(ball.centre), distance);
  EXPECT_GT(range_towards(ball.centre + Eigen::Vector3d(0, 0, 0.95 * ball.radius)), distance + 0.5);
}

TEST(OcclusionMap, ContractsAreChecked) {
  const DepthView large(kRoom.Render({128, 64}, kSource), kSource, 1.0, 0.01);
  EXPECT_THROW(OcclusionMap(large, View(kReference, 0.99)), ContractError);
}

}  // namespace
}  // namespace orb360
