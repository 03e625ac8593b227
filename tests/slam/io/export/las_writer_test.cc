#include "slam/io/export/las_writer.h"

#include <cstring>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

Eigen::AlignedBox3d Box(const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  return {min, max};
}

/// The number that is stored at a byte.
template <typename Number>
Number At(const std::string& bytes, size_t offset) {
  Number number{};
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

std::string TextAt(const std::string& bytes, size_t offset) { return bytes.data() + offset; }

TEST(LasQuantization, StepsAreAMillimetreUnlessTheExtentAsksForOthers) {
  EXPECT_EQ(QuantizationOf(Box({0, 0, 0}, {10, 1, 1})).scale, 0.001);
  EXPECT_EQ(QuantizationOf(Box({0, 0, 0}, {4e6, 1, 1})).scale, 0.001);
  EXPECT_EQ(QuantizationOf(Box({0, 0, 0}, {9.9, 1, 1})).scale, 0.0001);
  EXPECT_EQ(QuantizationOf(Box({0, 0, 0}, {5e6, 1, 1})).scale, 0.01);
  EXPECT_EQ(QuantizationOf(Box({0, 0, 0}, {1, 1, 1e12})).scale, 1000);
  EXPECT_EQ(QuantizationOf(Box({0, 0, 0}, {1e-20, 0, 0})).scale, 1e-9);
  EXPECT_EQ(QuantizationOf(Box({5, 5, 5}, {5, 5, 5})).scale, 0.001) << "one point";
}

TEST(LasQuantization, CornersOfAnyBoundsFitIn32Bits) {
  for (const double extent : {0.0, 1e-9, 0.3, 9.9, 4294967.0, 4294969.0, 1e9, 3e38}) {
    for (const double center : {0.0, 0.5, -471000.4999, 5.2e6}) {
      const Eigen::AlignedBox3d bounds = Box(Eigen::Vector3d::Constant(center - extent / 2),
                                             Eigen::Vector3d::Constant(center + extent / 2));
      const LasQuantization quantization = QuantizationOf(bounds);
      EXPECT_EQ(quantization.offset, Eigen::Vector3d(quantization.offset.array().round()));
      for (const Eigen::Vector3d& corner : {bounds.min(), bounds.max()}) {
        const Eigen::Vector3d steps = (corner - quantization.offset) / quantization.scale;
        EXPECT_LE(steps.cwiseAbs().maxCoeff(), 2147483647.0) << extent << " at " << center;
      }
    }
  }
}

TEST(LasWriter, WritesTheFieldsAtTheBytesThatTheSpecificationNames) {
  const TempFolder folder;
  const LasDescription description{2, Box({471000.25, 5247000, -3}, {471100.5, 5247010, 4}),
                                   "PROJCS[\"x\"]", false};
  LasWriter writer(folder / "a.las", description);
  writer.Append({471000.25, 5247010, -3}, {0, 128, 255}, 0);
  writer.Append({471100.5, 5247000, 4}, {1, 2, 3}, 0);
  writer.Commit();
  const std::string bytes = ReadText(folder / "a.las");
  EXPECT_EQ(bytes.substr(0, 4), "LASF");
  EXPECT_EQ(At<uint16_t>(bytes, 6), 16) << "global encoding: WKT";
  EXPECT_EQ(bytes.substr(8, 16), std::string(16, '\0')) << "GUID";
  EXPECT_EQ(bytes.substr(24, 2), "\x01\x04") << "version";
  EXPECT_EQ(TextAt(bytes, 26), "OTHER");
  EXPECT_EQ(TextAt(bytes, 58), "orb360");
  EXPECT_EQ(At<uint32_t>(bytes, 90), 0U) << "date";
  EXPECT_EQ(At<uint16_t>(bytes, 94), 375) << "size of the header";
  const size_t wkt_bytes = 54 + description.wkt.size() + 1;
  EXPECT_EQ(At<uint32_t>(bytes, 96), 375 + wkt_bytes) << "offset of the points";
  EXPECT_EQ(At<uint32_t>(bytes, 100), 1U) << "variable length records";
  EXPECT_EQ(At<uint8_t>(bytes, 104), 7) << "point format";
  EXPECT_EQ(At<uint16_t>(bytes, 105), 36) << "bytes of a point";
  EXPECT_EQ(bytes.substr(107, 24), std::string(24, '\0')) << "counts of older versions";
  for (size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(At<double>(bytes, 131 + 8 * axis), 0.001);
  EXPECT_EQ(At<double>(bytes, 155), 471050);
  EXPECT_EQ(At<double>(bytes, 163), 5247005);
  EXPECT_EQ(At<double>(bytes, 171), 1) << "0.5 is rounded away from zero";
  EXPECT_EQ(At<double>(bytes, 179), 471100.5) << "largest x";
  EXPECT_EQ(At<double>(bytes, 187), 471000.25) << "smallest x";
  EXPECT_EQ(At<double>(bytes, 195), 5247010);
  EXPECT_EQ(At<double>(bytes, 203), 5247000);
  EXPECT_EQ(At<double>(bytes, 211), 4);
  EXPECT_EQ(At<double>(bytes, 219), -3);
  EXPECT_EQ(bytes.substr(227, 20), std::string(20, '\0')) << "waveforms, extended records";
  EXPECT_EQ(At<uint64_t>(bytes, 247), 2U) << "points";
  EXPECT_EQ(At<uint64_t>(bytes, 255), 2U) << "first returns";
  EXPECT_EQ(bytes.substr(263, 112), std::string(112, '\0')) << "other returns";

  EXPECT_EQ(TextAt(bytes, 377), "LASF_Projection");
  EXPECT_EQ(At<uint16_t>(bytes, 393), 2112);
  EXPECT_EQ(At<uint16_t>(bytes, 395), description.wkt.size() + 1);
  EXPECT_EQ(bytes.substr(429, description.wkt.size() + 1), description.wkt + '\0');

  ASSERT_EQ(bytes.size(), 375 + wkt_bytes + 2 * 36);
  const std::string point = bytes.substr(375 + wkt_bytes, 36);
  EXPECT_EQ(At<int32_t>(point, 0), -49750);
  EXPECT_EQ(At<int32_t>(point, 4), 5000);
  EXPECT_EQ(At<int32_t>(point, 8), -4000);
  EXPECT_EQ(At<uint16_t>(point, 12), 0) << "intensity";
  EXPECT_EQ(At<uint8_t>(point, 14), 0x11) << "return 1 of 1";
  EXPECT_EQ(point.substr(15, 15), std::string(15, '\0'));
  EXPECT_EQ(At<uint16_t>(point, 30), 0);
  EXPECT_EQ(At<uint16_t>(point, 32), 0x8080);
  EXPECT_EQ(At<uint16_t>(point, 34), 0xffff);
}

TEST(LasWriter, DescribesTheConfidenceBehindEachPoint) {
  const TempFolder folder;
  LasWriter writer(folder / "a.las", {1, Box({0, 0, 0}, {20, 0, 0}), "", true});
  writer.Append({20, 0, 0}, {1, 2, 3}, 0.25F);
  writer.Commit();
  const std::string bytes = ReadText(folder / "a.las");
  EXPECT_EQ(At<uint32_t>(bytes, 100), 1U) << "variable length records";
  EXPECT_EQ(At<uint16_t>(bytes, 105), 40) << "bytes of a point";
  EXPECT_EQ(TextAt(bytes, 377), "LASF_Spec");
  EXPECT_EQ(At<uint16_t>(bytes, 393), 4);
  EXPECT_EQ(At<uint16_t>(bytes, 395), 192);
  EXPECT_EQ(At<uint8_t>(bytes, 429 + 2), 9) << "float";
  EXPECT_EQ(At<uint8_t>(bytes, 429 + 3), 0) << "nothing beside the value";
  EXPECT_EQ(TextAt(bytes, 429 + 4), "confidence");
  EXPECT_THAT(bytes.substr(429 + 160, 32), testing::StartsWith("1/c - 1"));
  ASSERT_EQ(bytes.size(), 375 + 54 + 192 + 40);
  EXPECT_EQ(At<int32_t>(bytes, bytes.size() - 40), 10000);
  EXPECT_EQ(At<float>(bytes, bytes.size() - 4), 0.25F);
}

TEST(LasWriter, AFileWithoutAllItsPointsNeverAppears) {
  const TempFolder folder;
  {
    LasWriter writer(folder / "a.las", {2, Box({0, 0, 0}, {1, 1, 1}), "", false});
    writer.Append({0, 0, 0}, {}, 0);
    EXPECT_THROW(writer.Commit(), ContractError);
    writer.Append({1, 1, 1}, {}, 0);
    EXPECT_THROW(writer.Append({0, 1, 1}, {}, 0), ContractError);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace orb360
