#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "nn/base/number_text.h"
#include "slam/io/atomic_file.h"
#include "slam/io/optical_frame.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

void AppendNumber(std::string* line, double value, std::chars_format format, int precision) {
  std::array<char, 400> buffer;  // A fixed-point double has up to 309 digits before the point.
  // Adding zero turns -0 into 0.
  const auto result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value + 0.0, format, precision);
  line->append(buffer.data(), result.ptr);
}

/// Splits a line into words separated by blanks; a carriage return counts as a blank.
std::vector<std::string_view> Words(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::vector<std::string_view> words;
  for (size_t begin = line.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
  return words;
}

/// Parses the words of a line. The message of the UserError begins with `where`.
StampedPose ParsePose(const std::vector<std::string_view>& words, const std::string& where) {
  std::array<double, 8> values{};
  if (words.size() != values.size()) {
    throw UserError(where + "expected `timestamp tx ty tz qx qy qz qw`, found " +
                    std::to_string(words.size()) + " words");
  }
  for (size_t i = 0; i < values.size(); ++i) {
    const std::optional<double> value = ParseNumber<double>(words[i]);
    if (!value || !std::isfinite(*value)) {
      throw UserError(where + "`" + std::string(words[i]) + "` is not a number");
    }
    values[i] = *value;
  }
  const Eigen::Quaterniond rotation(values[7], values[4], values[5], values[6]);
  if (std::abs(rotation.norm() - 1.0) > 0.01) {
    throw UserError(where + "the quaternion's length is " + ToText(rotation.norm()) + ", not 1");
  }
  return {values[0],
          {(rotation.normalized() * CameraFromOptical().conjugate()).normalized(),
           {values[1], values[2], values[3]}}};
}

}  // namespace

Rigid3 FileWorldFromMap(const Rigid3& map_from_first_camera,
                        const std::optional<Eigen::Vector3d>& up_in_map) {
  // The camera's forward, left and up directions in the map.
  Eigen::Matrix3d map_from_file;
  map_from_file.col(0) = map_from_first_camera.rotation * -Eigen::Vector3d::UnitX();
  map_from_file.col(1) = map_from_first_camera.rotation * -Eigen::Vector3d::UnitY();
  map_from_file.col(2) = map_from_first_camera.rotation * Eigen::Vector3d::UnitZ();
  if (up_in_map) {
    const Eigen::Vector3d up = up_in_map->normalized();
    const Eigen::Vector3d forward = map_from_file.col(0);
    const Eigen::Vector3d left = map_from_file.col(1);
    // Within half a degree of the vertical, the forward direction has no heading.
    const Eigen::Vector3d level_left =
        up.cross(forward).norm() > 0.01 ? up.cross(forward) : left - left.dot(up) * up;
    map_from_file.col(2) = up;
    map_from_file.col(1) = level_left.normalized();
    map_from_file.col(0) = map_from_file.col(1).cross(up);
  }
  return Rigid3{Eigen::Quaterniond(map_from_file), map_from_first_camera.translation}.Inverse();
}

std::string FormatTumLine(const StampedPose& pose) {
  const Rigid3& camera = pose.world_from_camera;
  Eigen::Quaterniond rotation = WorldFromOptical(camera).rotation;
  if (rotation.w() < 0.0) rotation.coeffs() = -rotation.coeffs();
  std::string line;
  AppendNumber(&line, pose.timestamp, std::chars_format::fixed, 9);
  for (const double value : {camera.translation.x(), camera.translation.y(), camera.translation.z(),
                             rotation.x(), rotation.y(), rotation.z(), rotation.w()}) {
    line += ' ';
    AppendNumber(&line, value, std::chars_format::general, 9);
  }
  return line;
}

void WriteTrajectory(const std::filesystem::path& path, std::span<const StampedPose> poses,
                     const Rigid3& file_world_from_map) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : poses) {
    text += FormatTumLine({pose.timestamp, file_world_from_map * pose.world_from_camera}) + "\n";
  }
  WriteFileAtomically(path, text);
}

std::vector<StampedPose> ReadTrajectory(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw UserError(path.string() + ": cannot be opened as a trajectory file");
  }
  std::vector<StampedPose> poses;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::vector<std::string_view> words = Words(line);
    if (words.empty() || words.front().starts_with('#')) continue;
    poses.push_back(ParsePose(words, path.string() + ":" + std::to_string(number) + ": "));
  }
  if (poses.empty()) throw UserError(path.string() + ": contains no pose");
  return poses;
}

}  // namespace orb360
