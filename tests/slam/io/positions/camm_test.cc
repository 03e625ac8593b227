#include "slam/io/positions/camm.h"

#include <gtest/gtest.h>

#include "tests/slam/io/positions/camm_writer.h"

namespace orb360 {
namespace {

TEST(Camm, ReadsAllPacketsOfASample) {
  const CammPositions positions =
      ParseCamm(CammType2() + CammType5(1.5, 2.5, 3.5) + CammType6(7, 3, -4.5, 5.5, 6.5F, 3, 4) +
                CammType6(8, 0, 1, 1, 1, 1, 1) + CammType6(9, 2, -4.5, 5.5, 6.5F, 0, 0));
  ASSERT_EQ(positions.without_accuracy.size(), 1U);
  EXPECT_EQ(positions.without_accuracy[0].longitude, 2.5);
  EXPECT_EQ(*positions.without_accuracy[0].altitude, 3.5);
  ASSERT_EQ(positions.with_accuracy.size(), 2U);
  EXPECT_EQ(positions.with_accuracy[0].latitude, -4.5);
  EXPECT_EQ(*positions.with_accuracy[0].vertical_sigma, 4);
  EXPECT_FALSE(positions.with_accuracy[1].altitude);
  EXPECT_FALSE(positions.with_accuracy[1].horizontal_sigma);
  EXPECT_EQ(*positions.gps_time, 7);
  EXPECT_EQ(positions.num_without_lock, 1);
}

TEST(Camm, EndsAtAPacketThatIsCutOffOrUnknown) {
  const std::string packet = CammType5(1.5, 2.5, 3.5);
  EXPECT_EQ(ParseCamm(packet + packet.substr(0, 27)).without_accuracy.size(), 1U);
  EXPECT_EQ(ParseCamm(packet + CammHeader(8) + packet).without_accuracy.size(), 1U);
  EXPECT_TRUE(ParseCamm("").without_accuracy.empty());
}

}  // namespace
}  // namespace orb360
