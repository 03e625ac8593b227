#include "slam/io/octree/thin_octree.h"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "slam/io/octree/octree_writer.h"
#include "tests/slam/io/octree/synthetic_surfaces.h"
#include "tests/slam/io/temp_folder.h"

namespace orb360 {
namespace {

class ThinOctreeTest : public testing::Test {
 protected:
  ThinOctreeTest() : points_(Surfaces(150000)) {
    WriteSurfaces(folder_ / "cloud.ply", points_);
    WriteOctree(folder_ / "whole.octree", folder_ / "cloud.ply");
  }

  OctreeFile Thin(std::uint64_t max_points) const {
    const OctreeFile whole(folder_ / "whole.octree");
    WriteText(folder_ / "thin.octree", ThinOctree(whole, max_points));
    return OctreeFile(folder_ / "thin.octree");
  }

  const TempFolder folder_;
  const std::vector<SurfacePoint> points_;
};

TEST_F(ThinOctreeTest, HasAlmostAsManyPointsAsItMay) {
  for (const std::uint64_t max_points : {1U, 1000U, 20000U, 77777U, 149999U}) {
    const OctreeFile thin = Thin(max_points);
    EXPECT_LE(thin.header().point_count, max_points);
    EXPECT_GE(static_cast<double>(thin.header().point_count),
              0.99 * static_cast<double>(max_points));
    std::set<int> numbers;
    for (const OctreeNode& node : thin.nodes()) {
      for (const SurfacePoint& read : thin.ReadPoints(node)) {
        ASSERT_TRUE(numbers.insert(NumberOf(read)).second);
        ASSERT_LT((read.position - points_.at(NumberOf(read)).position).norm(), 2e-3f);
      }
    }
    EXPECT_EQ(numbers.size(), thin.header().point_count);
  }
}

TEST_F(ThinOctreeTest, NamesNoChildrenThatItLacks) {
  const OctreeFile thin = Thin(40000);
  size_t named = 1;
  for (const OctreeNode& node : thin.nodes()) {
    for (int child = 0; child < 8; ++child) named += node.children >> child & 1;
  }
  EXPECT_EQ(named, thin.nodes().size());
  EXPECT_LT(thin.nodes().size(), OctreeFile(folder_ / "whole.octree").nodes().size());
}

TEST_F(ThinOctreeTest, IsTheWholeOneWhereThatFits) {
  const OctreeFile thin = Thin(1000000);
  EXPECT_EQ(thin.header().point_count, points_.size());
  EXPECT_EQ(thin.nodes().size(), OctreeFile(folder_ / "whole.octree").nodes().size());
}

}  // namespace
}  // namespace orb360
