#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/io/crc32.h"
#include "slam/io/octree/octree_file.h"
#include "slam/io/octree/octree_writer.h"
#include "slam/io/ply.h"
#include "tests/slam/io/octree/synthetic_surfaces.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Position of a node among those of its level.
std::tuple<int, std::uint32_t, std::uint32_t, std::uint32_t> KeyOf(const OctreeNode& node) {
  return {node.level, node.cell[0], node.cell[1], node.cell[2]};
}

/// Tells the cell of a level in which a position lies.
class CellFinder {
 public:
  CellFinder(const OctreeHeader& header, int level)
      : header_(header), cell_(std::ldexp(header.side, -level) / header.cells_per_side) {}

  std::array<int, 3> operator()(const Eigen::Vector3f& position) const {
    std::array<int, 3> at{};
    for (int axis = 0; axis < 3; ++axis) {
      // The point at the upper end is in the last cell.
      at[axis] =
          std::min(static_cast<int>(std::floor((position[axis] - header_.min[axis]) / cell_)),
                   static_cast<int>(std::lround(header_.side / cell_)) - 1);
    }
    return at;
  }

 private:
  const OctreeHeader& header_;
  const double cell_;
};

class OctreeTest : public testing::Test {
 protected:
  void Write(int count) {
    points_ = Surfaces(count);
    WriteSurfaces(folder_ / "cloud.ply", points_);
    EXPECT_EQ(WriteOctree(folder_ / "a.octree", folder_ / "cloud.ply"), points_.size());
  }

  const TempFolder folder_;
  std::vector<SurfacePoint> points_;
};

TEST_F(OctreeTest, HasEveryPointInExactlyOneNodeWithItsValues) {
  Write(200000);
  const OctreeFile octree(folder_ / "a.octree");
  EXPECT_EQ(octree.header().attributes, kOctreeNormals | kOctreeConfidences);
  EXPECT_GT(octree.nodes().size(), 30U);
  std::vector<int> seen(points_.size(), 0);
  for (const OctreeNode& node : octree.nodes()) {
    const double side = std::ldexp(octree.header().side, -node.level);
    // Half a step, and the rounding of both positions to float.
    const double bound = 0.5 * side / 65536 + 2 * 30 * 6e-8;
    for (const SurfacePoint& read : octree.ReadPoints(node)) {
      const SurfacePoint& point = points_.at(NumberOf(read));
      ++seen[NumberOf(read)];
      ASSERT_LE((read.position - point.position).cwiseAbs().maxCoeff(), bound);
      ASSERT_GT(read.normal.dot(point.normal), 0.9998f);
      ASSERT_NEAR(read.confidence, point.confidence, 0.5f / 255 + 1e-6f);
    }
  }
  EXPECT_THAT(seen, testing::Each(1));
}

TEST_F(OctreeTest, ShowsTheMostConfidentPointOfEachCell) {
  Write(200000);
  const OctreeFile octree(folder_ / "a.octree");
  const OctreeHeader& header = octree.header();
  for (int level = 0; level < 3; ++level) {
    const CellFinder cell_of(header, level);
    const auto stored = [](const SurfacePoint& point) {
      return std::lround(255 * point.confidence);
    };
    std::map<std::array<int, 3>, long> best;
    for (const SurfacePoint& point : points_) {
      long& confidence = best[cell_of(point.position)];
      confidence = std::max(confidence, stored(point));
    }
    std::map<std::array<int, 3>, long> shown;
    for (const OctreeNode& node : octree.nodes()) {
      if (node.level > level) continue;
      for (const SurfacePoint& read : octree.ReadPoints(node)) {
        long& confidence = shown[cell_of(points_[NumberOf(read)].position)];
        confidence = std::max(confidence, stored(read));
      }
    }
    EXPECT_EQ(shown, best) << "level " << level;
  }
}

TEST_F(OctreeTest, HalvesTheSpacingOnEachLevel) {
  Write(200000);
  const OctreeFile octree(folder_ / "a.octree");
  const OctreeHeader& header = octree.header();
  int deepest = 0;
  for (const OctreeNode& node : octree.nodes()) deepest = std::max<int>(deepest, node.level);
  ASSERT_GE(deepest, 3);
  for (int level = 0; level < deepest; ++level) {
    const CellFinder cell_of(header, level);
    // No cell has two points of inner nodes down to this level, and each that has a point at all
    // has one of them, or lies in a leaf that is not coarser. Positions near a border are left out,
    // where quantization may have moved them into the next cell.
    std::map<std::array<int, 3>, int> shown;
    for (const OctreeNode& node : octree.nodes()) {
      if (node.level > level) continue;
      for (const SurfacePoint& read : octree.ReadPoints(node)) {
        const Eigen::Vector3f& exact = points_[NumberOf(read)].position;
        int& count = shown[cell_of(exact)];
        count = node.children == 0 ? -1000000 : count + 1;
      }
    }
    for (const auto& [at, count] : shown) ASSERT_LE(count, 1) << "level " << level;
    std::set<std::array<int, 3>> occupied;
    for (const SurfacePoint& point : points_) occupied.insert(cell_of(point.position));
    EXPECT_NEAR(static_cast<double>(shown.size()), static_cast<double>(occupied.size()),
                0.002 * static_cast<double>(occupied.size()));
  }
}

TEST_F(OctreeTest, NamesTheChildrenOfEachNode) {
  Write(100000);
  const OctreeFile octree(folder_ / "a.octree");
  std::set<std::tuple<int, std::uint32_t, std::uint32_t, std::uint32_t>> keys;
  for (const OctreeNode& node : octree.nodes()) EXPECT_TRUE(keys.insert(KeyOf(node)).second);
  size_t named = 1;  // the root
  for (const OctreeNode& node : octree.nodes()) {
    if (node.children != 0) {
      EXPECT_LE(node.point_count, std::pow(octree.header().cells_per_side, 3));
    } else {
      EXPECT_LE(node.point_count, kOctreeLeafPoints);
    }
    for (unsigned child = 0; child < 8; ++child) {
      if ((node.children >> child & 1) == 0) continue;
      ++named;
      EXPECT_TRUE(
          keys.contains({node.level + 1, 2 * node.cell[0] + (child >> 2 & 1),
                         2 * node.cell[1] + (child >> 1 & 1), 2 * node.cell[2] + (child & 1)}));
    }
  }
  EXPECT_EQ(named, keys.size());
}

TEST_F(OctreeTest, LeavesNothingBehindWhenItIsEnded) {
  Write(200000);
  std::filesystem::remove(folder_ / "a.octree");
  struct Ended {};
  for (const int num_calls : {1, 5, 8}) {  // while points are measured, sorted, merged
    int left = num_calls;
    const auto check = [&left] {
      if (--left == 0) throw Ended();
    };
    EXPECT_THROW(WriteOctree(folder_ / "a.octree", folder_ / "cloud.ply", {100000, check}), Ended);
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "")) {
    EXPECT_EQ(entry.path().filename(), "cloud.ply");
  }
}

TEST_F(OctreeTest, HasTheSameBytesForAnyAmountOfMemory) {
  Write(60000);
  const std::string bytes = ReadText(folder_ / "a.octree");
  for (const size_t max_in_memory : {60001, 60000, 12345, 1000}) {
    WriteOctree(folder_ / "b.octree", folder_ / "cloud.ply", {max_in_memory, nullptr});
    EXPECT_EQ(ReadText(folder_ / "b.octree"), bytes);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "b.octree.sort"));
}

TEST_F(OctreeTest, OfLandmarksHasNeitherNormalsNorConfidences) {
  WritePly(folder_ / "cloud.ply",
           std::vector<ColoredPoint>{{{1, 2, 3}, {4, 5, 6}}, {{1, 2, 4}, {7, 8, 9}}});
  EXPECT_EQ(WriteOctree(folder_ / "a.octree", folder_ / "cloud.ply"), 2U);
  const OctreeFile octree(folder_ / "a.octree");
  EXPECT_EQ(octree.header().attributes, 0U);
  ASSERT_EQ(octree.nodes().size(), 1U);
  const std::vector<SurfacePoint> points = octree.ReadPoints(octree.nodes()[0]);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].normal, Eigen::Vector3f::Zero());
  EXPECT_EQ(points[1].confidence, 0.0f);
}

TEST_F(OctreeTest, CanHaveAllPointsInOnePlace) {
  SurfacePoint point;
  point.position = {5, 5, 5};
  WriteSurfaces(folder_ / "cloud.ply", std::vector<SurfacePoint>(20000, point));
  EXPECT_EQ(WriteOctree(folder_ / "a.octree", folder_ / "cloud.ply"), 20000U);
  const OctreeFile octree(folder_ / "a.octree");
  for (const SurfacePoint& read : octree.ReadPoints(octree.nodes().back())) {
    ASSERT_LT((read.position - point.position).norm(), 1e-4f);
  }
}

TEST_F(OctreeTest, RefusesCloudsWithoutPointsOrWithPositionsThatAreNotFinite) {
  WriteSurfaces(folder_ / "cloud.ply", {});
  const auto write = [&] { WriteOctree(folder_ / "a.octree", folder_ / "cloud.ply"); };
  EXPECT_THAT(MessageOf<UserError>(write), HasSubstr("no points"));
  SurfacePoint point;
  point.position.x() = NAN;
  WriteSurfaces(folder_ / "cloud.ply", {point});
  EXPECT_THAT(MessageOf<UserError>(write), HasSubstr("point 0"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.octree"));
}

TEST_F(OctreeTest, SaysWhatIsWrongWithAFileInOneLine) {
  Write(30000);
  const auto message = [&](const std::string& name) {
    return MessageOf<UserError>([&] {
      const OctreeFile octree(folder_ / name);
      for (const OctreeNode& node : octree.nodes()) octree.ReadBytes(node);
    });
  };
  EXPECT_THAT(message("absent.octree"), HasSubstr("absent.octree: cannot be opened"));
  CopyTruncated(folder_ / "a.octree", folder_ / "cut.octree", 0.7);
  EXPECT_THAT(message("cut.octree"),
              AllOf(HasSubstr("cut.octree: is truncated"), Not(HasSubstr("\n"))));
  CopyTruncated(folder_ / "a.octree", folder_ / "short.octree", 1e-4);
  EXPECT_THAT(message("short.octree"), HasSubstr("damaged"));
  const std::string bytes = ReadText(folder_ / "a.octree");
  std::string newer = bytes;
  newer[8] = 9;
  WriteText(folder_ / "newer.octree", newer);
  EXPECT_THAT(message("newer.octree"), HasSubstr("version 9"));
  // A byte of the header, of points, and of the index.
  for (const size_t at : {size_t{30}, size_t{500}, bytes.size() - 5}) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    WriteText(folder_ / "bad.octree", damaged);
    EXPECT_THAT(message("bad.octree"), HasSubstr("damaged")) << at;
  }
}

/// Writes the checksums of header and index anew, as somebody would who wants to get past them.
void WriteChecksums(std::string* bytes) {
  OctreeHeader header{};
  std::memcpy(&header, bytes->data(), sizeof header);
  if (header.index_offset <= bytes->size()) {
    header.index_crc = Crc32(std::string_view(*bytes).substr(header.index_offset));
  }
  std::memcpy(bytes->data(), &header, sizeof header);
  header.header_crc = Crc32(std::string_view(*bytes).substr(0, offsetof(OctreeHeader, header_crc)));
  std::memcpy(bytes->data(), &header, sizeof header);
}

TEST_F(OctreeTest, SurvivesFilesWhoseChecksumsFitWhatWasChangedInThem) {
  Write(20000);
  const std::string whole = ReadText(folder_ / "a.octree");
  const size_t index = whole.size() - OctreeFile(folder_ / "a.octree").nodes().size() * 32;
  std::mt19937 random(6);
  int num_refused = 0;
  for (int i = 0; i < 500; ++i) {
    std::string bytes = whole;
    for (unsigned edits = 1 + random() % 4; edits > 0; --edits) {
      const size_t at = random() % 2 == 0 ? 12 + random() % (sizeof(OctreeHeader) - 12)
                                          : index + random() % (whole.size() - index);
      bytes[at] = static_cast<char>(random());
    }
    WriteChecksums(&bytes);
    WriteText(folder_ / "bad.octree", bytes);
    try {
      const OctreeFile octree(folder_ / "bad.octree");
      for (const OctreeNode& node : octree.nodes()) octree.ReadPoints(node);
    } catch (const UserError&) {
      ++num_refused;
    }
  }
  EXPECT_GT(num_refused, 200);
}

}  // namespace
}  // namespace orb360
