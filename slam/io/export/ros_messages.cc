#include "slam/io/export/ros_messages.h"

#include <utility>

#include "slam/io/export/cdr.h"
#include "slam/io/export/pose_text.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

void Write(const RosHeader& header, CdrWriter* cdr) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  ORB360_CHECK(header.stamp >= 0 && header.stamp <= kMaxRosTime, header.stamp);
  cdr->Write(static_cast<std::int32_t>(header.stamp / kSecond));
  cdr->Write(static_cast<std::uint32_t>(header.stamp % kSecond));
  cdr->WriteText(header.frame);
}

/// Position and quaternion x, y, z, w.
void Write(const Rigid3& pose, CdrWriter* cdr) {
  for (const double coordinate : pose.translation) cdr->Write(coordinate);
  const auto [w, x, y, z] = ScalarFirst(pose.rotation);
  for (const double component : {x, y, z, w}) cdr->Write(component);
}

void WritePoseStamped(const RosPose& pose, CdrWriter* cdr) {
  Write(pose.header, cdr);
  Write(pose.header_from_child, cdr);
}

}  // namespace

std::string RosTransforms(std::span<const RosPose> poses) {
  CdrWriter cdr;
  cdr.WriteCount(poses.size());
  for (const RosPose& pose : poses) {
    Write(pose.header, &cdr);
    cdr.WriteText(pose.child);
    Write(pose.header_from_child, &cdr);
  }
  return cdr.Take();
}

std::string RosPoseStamped(const RosPose& pose) {
  CdrWriter cdr;
  WritePoseStamped(pose, &cdr);
  return cdr.Take();
}

std::string RosPath(const RosHeader& header, std::span<const RosPose> poses) {
  CdrWriter cdr;
  Write(header, &cdr);
  cdr.WriteCount(poses.size());
  for (const RosPose& pose : poses) WritePoseStamped(pose, &cdr);
  return cdr.Take();
}

std::string RosCompressedImage(const RosHeader& header, std::string_view format,
                               std::string_view data) {
  CdrWriter cdr;
  Write(header, &cdr);
  cdr.WriteText(format);
  cdr.WriteBytes(data);
  return cdr.Take();
}

std::string RosPointCloud(const RosHeader& header, std::span<const RosPoint> points) {
  constexpr std::uint8_t kFloat32 = 7;
  constexpr std::uint32_t kPointBytes = 16;
  std::string data;
  data.reserve(points.size() * kPointBytes);
  for (const RosPoint& point : points) {
    for (const float coordinate : point.position) AppendLittleEndian(coordinate, &data);
    AppendLittleEndian(
        static_cast<std::uint32_t>(point.rgb[0] << 16 | point.rgb[1] << 8 | point.rgb[2]), &data);
  }
  CdrWriter cdr;
  Write(header, &cdr);
  cdr.Write<std::uint32_t>(1);  // height: The points are in no order.
  cdr.WriteCount(points.size());
  constexpr std::pair<std::string_view, std::uint32_t> kFields[] = {
      {"x", 0}, {"y", 4}, {"z", 8}, {"rgb", 12}};
  cdr.WriteCount(std::size(kFields));
  for (const auto& [name, offset] : kFields) {
    cdr.WriteText(name);
    cdr.Write(offset);
    cdr.Write(kFloat32);
    cdr.Write<std::uint32_t>(1);
  }
  cdr.Write<std::uint8_t>(0);  // little endian
  cdr.Write(kPointBytes);
  cdr.WriteCount(data.size());  // bytes in the only row
  cdr.WriteBytes(data);
  cdr.Write<std::uint8_t>(1);  // All points are valid.
  return cdr.Take();
}

std::string RosNavSatFix(const RosFix& fix) {
  constexpr std::int8_t kFix = 0;
  constexpr std::uint16_t kUnknownService = 0;
  constexpr std::uint8_t kApproximated = 1;
  CdrWriter cdr;
  Write(fix.header, &cdr);
  cdr.Write(kFix);
  cdr.Write(kUnknownService);
  cdr.Write(fix.point.latitude);
  cdr.Write(fix.point.longitude);
  cdr.Write(fix.point.height);
  for (int row = 0; row < 3; ++row) {
    const double sigma = row < 2 ? fix.horizontal_sigma : fix.vertical_sigma;
    for (int column = 0; column < 3; ++column) cdr.Write(row == column ? sigma * sigma : 0.0);
  }
  cdr.Write(kApproximated);
  return cdr.Take();
}

}  // namespace orb360
