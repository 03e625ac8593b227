#include "slam/io/export/ros_messages.h"

#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/io/byte_number.h"
#include "slam/io/export/ros_definitions.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using std::string_literals::operator""s;

constexpr std::int64_t kStamp = 3'000'000'005;  // 3 s and 5 ns

std::string Doubles(const std::vector<double>& numbers) {
  std::string bytes;
  for (const double number : numbers) AppendLittleEndian(number, &bytes);
  return bytes;
}

// 3 s, 5 ns and the frame "map", 16 bytes.
const std::string kHeader = "\3\0\0\0\5\0\0\0\4\0\0\0map\0"s;
const std::string kEncoding = "\0\1\0\0"s;

// A quaternion with w < 0, which is written with w > 0.
const RosPose kPose{{kStamp, "map"}, "cam", {{-0.5, 0.5, 0.5, 0.5}, {1, 2, 3}}};
const std::vector<double> kPoseNumbers = {1, 2, 3, -0.5, -0.5, -0.5, 0.5};

TEST(RosMessages, TransformsHaveParentChildPositionAndQuaternionXyzw) {
  EXPECT_EQ(RosTransforms({&kPose, 1}),
            kEncoding + "\1\0\0\0"s + kHeader + "\4\0\0\0cam\0\0\0\0\0"s + Doubles(kPoseNumbers));
}

TEST(RosMessages, PathsArePosesBehindTheirNumber) {
  EXPECT_EQ(RosPoseStamped(kPose), kEncoding + kHeader + Doubles(kPoseNumbers));
  const RosPose poses[] = {kPose, kPose};
  const std::string pose = kHeader + Doubles(kPoseNumbers);
  // The numbers of the first pose are aligned to 8 bytes: 16 + 4 + 16 + 4.
  EXPECT_EQ(RosPath(kPose.header, poses), kEncoding + kHeader + "\2\0\0\0"s + kHeader +
                                              "\0\0\0\0"s + Doubles(kPoseNumbers) + pose);
}

TEST(RosMessages, ImagesAreBytesOfANamedFormat) {
  EXPECT_EQ(RosCompressedImage({kStamp, "map"}, "jpeg", "\xff\xd8\xff"s),
            kEncoding + kHeader + "\5\0\0\0jpeg\0\0\0\0"s + "\3\0\0\0\xff\xd8\xff"s);
}

TEST(RosMessages, PointsHaveFloatsAndAPackedColour) {
  const RosPoint points[] = {{{1, -2, 0.5F}, {0x10, 0x20, 0x30}}};
  const std::string bytes = RosPointCloud({kStamp, "map"}, points);
  const std::string field_x = "\2\0\0\0x\0\0\0\0\0\0\0\7\0\0\0\1\0\0\0"s;
  const std::string field_y = "\2\0\0\0y\0\0\0\4\0\0\0\7\0\0\0\1\0\0\0"s;
  const std::string field_z = "\2\0\0\0z\0\0\0\x08\0\0\0\7\0\0\0\1\0\0\0"s;
  const std::string field_rgb = "\4\0\0\0rgb\0\x0c\0\0\0\7\0\0\0\1\0\0\0"s;
  EXPECT_EQ(bytes, kEncoding + kHeader + "\1\0\0\0\1\0\0\0\4\0\0\0"s + field_x + field_y + field_z +
                       field_rgb + "\0\0\0\0\x10\0\0\0\x10\0\0\0\x10\0\0\0"s +
                       "\0\0\x80\x3f\0\0\0\xc0\0\0\0\x3f\x30\x20\x10\0"s + "\1"s);
}

TEST(RosMessages, FixesHaveVariancesOnTheDiagonal) {
  const RosFix fix{{kStamp, "map"}, {47.5, 8.25, 400}, 2, 3};
  EXPECT_EQ(RosNavSatFix(fix), kEncoding + kHeader + "\0\0\0\0\0\0\0\0"s +
                                   Doubles({47.5, 8.25, 400, 4, 0, 0, 0, 4, 0, 0, 0, 9}) + "\1"s);
}

TEST(RosMessages, AStampThatDoesNotFitIsABrokenContract) {
  EXPECT_THROW(RosPath({-1, "map"}, {}), ContractError);
  EXPECT_THROW(RosPath({kMaxRosTime + 1, "map"}, {}), ContractError);
  EXPECT_EQ(RosPath({kMaxRosTime, ""}, {}).substr(4, 4), "\xff\xff\xff\x7f");
}

TEST(RosDefinitions, ContainEveryTypeOnce) {
  EXPECT_EQ(
      RosDefinition("nav_msgs/msg/Path"),
      "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n" +  //
          std::string(80, '=') +
          "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" +
          std::string(80, '=') +
          "\nMSG: geometry_msgs/PoseStamped\nstd_msgs/Header header\nPose pose\n" +
          std::string(80, '=') + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n" +
          std::string(80, '=') +
          "\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n" +
          std::string(80, '=') + "\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" +
          std::string(80, '=') +
          "\nMSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\n"
          "float64 w 1\n");
  EXPECT_THROW(RosDefinition("std_msgs/msg/String"), ContractError);
}

}  // namespace
}  // namespace orb360
