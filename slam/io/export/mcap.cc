#include "slam/io/export/mcap.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "nn/base/number_text.h"
#include "slam/io/export/mcap_writer.h"
#include "slam/io/export/ros_definitions.h"
#include "slam/io/export/ros_messages.h"
#include "slam/io/image_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Frames of REP 105: the map, and the camera with axes x forward, y left, z up; of REP 103: its
// optical frame with axes x right, y down, z forward.
constexpr const char* kMapFrame = "map";
constexpr const char* kCameraFrame = "camera";
constexpr const char* kOpticalFrame = "camera_optical";

constexpr double kNanoseconds = 1e9;  // in a second

/// Rotation from the optical frame to the camera frame.
Eigen::Quaterniond CameraFromOpticalFrame() {
  Eigen::Matrix3d columns;
  columns << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return Eigen::Quaterniond(columns);
}

double UtcAtZero(const std::optional<Georeference>& georeference) {
  return georeference ? georeference->utc_at_zero.value_or(0) : 0;
}

/// How a player offers a topic: what is sent once is kept for those who listen later. This is the
/// text that rosbag2 stores; its numbers are those of rmw/types.h.
std::map<std::string, std::string> OfferedQuality(bool is_kept) {
  const std::string endless = "\n    sec: 9223372036\n    nsec: 854775807\n";
  return {
      {"offered_qos_profiles", std::string("- history: 1\n  depth: ") + (is_kept ? "1" : "10") +
                                   "\n  reliability: 1\n  durability: " + (is_kept ? "1" : "2") +
                                   "\n  deadline:" + endless + "  lifespan:" + endless +
                                   "  liveliness: 1\n  liveliness_lease_duration:" + endless +
                                   "  avoid_ros_namespace_conventions: false"}};
}

/// The topics of a file.
class Topics {
 public:
  explicit Topics(const std::filesystem::path& path) : writer_(path, "ros2") {}

  McapWriter::Id Add(const char* topic, const std::string& type, bool is_kept = false) {
    const auto [schema, is_new] = schemas_.try_emplace(type);
    if (is_new) schema->second = writer_.AddSchema(type, "ros2msg", RosDefinition(type));
    return writer_.AddChannel(schema->second, topic, "cdr", OfferedQuality(is_kept));
  }
  void Write(McapWriter::Id topic, std::int64_t time, const std::string& message) {
    writer_.Write(topic, static_cast<std::uint64_t>(time), message);
  }
  void Commit() { writer_.Commit(); }

 private:
  McapWriter writer_;
  std::map<std::string, McapWriter::Id> schemas_;
};

/// Places camera positions on Earth.
class Fixes {
 public:
  explicit Fixes(const Georeference& georeference)
      : georeference_(georeference), local_(Projection::Local(georeference.origin)) {}

  RosFix At(const Eigen::Vector3d& world_position, const RosHeader& header) const {
    const PositionAlignment& alignment = georeference_.alignment;
    const Similarity3& local_from_world = alignment.local_from_path;
    RosFix fix{header, local_.ToGeodetic(local_from_world * world_position), 0, 0};
    // Errors of the centre, and of the rotation and the scale about it.
    const double distance = local_from_world.scale * (world_position - alignment.center).norm();
    fix.horizontal_sigma =
        std::hypot(alignment.horizontal_sigma, distance * alignment.heading_sigma,
                   distance * alignment.log_scale_sigma);
    fix.vertical_sigma = std::hypot(alignment.vertical_sigma, distance * alignment.tilt_sigma);
    if (georeference_.altitude_reference != AltitudeReference::kEllipsoid) {
      fix.point.height = std::numeric_limits<double>::quiet_NaN();
      fix.vertical_sigma = std::numeric_limits<double>::infinity();
    }
    return fix;
  }

 private:
  const Georeference& georeference_;
  const Projection local_;
};

std::string PointsMessage(const ExportScene& scene, const Similarity3& map_from_world,
                          const RosHeader& header) {
  std::vector<RosPoint> points;
  points.reserve(scene.points().size());
  for (const ColoredLandmark& point : scene.points()) {
    points.push_back({(map_from_world * point.position).cast<float>(), point.color});
  }
  return RosPointCloud(header, points);
}

}  // namespace

void CheckRosTimes(const ExportScene& scene, const std::optional<Georeference>& georeference) {
  for (const PosedFrame& frame : scene.model.frames) {
    const double time = frame.timestamp + UtcAtZero(georeference);
    if (!(time >= 0 && time * kNanoseconds < static_cast<double>(kMaxRosTime))) {
      throw UserError("--to: the time of frame " + std::to_string(frame.index) + " is " +
                      ToText(time) +
                      " s, and messages of ROS have times from 0 to 2147483647 s; give the input "
                      "other times and run it again, or export tum");
    }
  }
}

void ExportMcap(const ExportScene& scene, const std::optional<Georeference>& georeference,
                const std::string& input, Sequence* sequence, const std::filesystem::path& folder,
                const ExportProgress& progress) {
  ORB360_CHECK(scene.views.size() == 1 && scene.views[0].is_panorama());
  const Similarity3 map_from_world =
      georeference ? georeference->alignment.local_from_path : Similarity3{};
  std::optional<Fixes> fixes;
  if (georeference) fixes.emplace(*georeference);

  std::vector<RosPose> poses;
  for (const PosedFrame& frame : scene.model.frames) {
    const double time = frame.timestamp + UtcAtZero(georeference);
    const Rigid3 map_from_optical = TransformPose(map_from_world, frame.world_from_optical);
    poses.push_back({{std::llround(time * kNanoseconds), kMapFrame},
                     kCameraFrame,
                     {map_from_optical.rotation * CameraFromOpticalFrame().inverse(),
                      map_from_optical.translation}});
  }

  Topics topics(folder / kMcapName);
  const auto tf_static = topics.Add("/tf_static", "tf2_msgs/msg/TFMessage", true);
  const auto path = topics.Add("/path", "nav_msgs/msg/Path", true);
  const auto points = topics.Add("/points", "sensor_msgs/msg/PointCloud2", true);
  const auto tf = topics.Add("/tf", "tf2_msgs/msg/TFMessage");
  const auto pose = topics.Add("/camera/pose", "geometry_msgs/msg/PoseStamped");
  McapWriter::Id fix = 0, image = 0;
  if (fixes) fix = topics.Add("/fix", "sensor_msgs/msg/NavSatFix");
  if (sequence != nullptr) {
    image = topics.Add("/camera/image/compressed", "sensor_msgs/msg/CompressedImage");
  }

  const RosHeader start = poses.front().header;
  const RosPose optical{{start.stamp, kCameraFrame},
                        kOpticalFrame,
                        {CameraFromOpticalFrame(), Eigen::Vector3d::Zero()}};
  topics.Write(tf_static, start.stamp, RosTransforms({&optical, 1}));
  topics.Write(path, start.stamp, RosPath(start, poses));
  topics.Write(points, start.stamp, PointsMessage(scene, map_from_world, start));
  const std::string format = scene.extension == ".png" ? "png" : "jpeg";
  const int count = static_cast<int>(poses.size());
  for (int f = 0; f < count; ++f) {
    const PosedFrame& frame = scene.model.frames[static_cast<size_t>(f)];
    const RosPose& camera = poses[static_cast<size_t>(f)];
    const std::int64_t time = camera.header.stamp;
    topics.Write(tf, time, RosTransforms({&camera, 1}));
    topics.Write(pose, time, RosPoseStamped(camera));
    if (fixes) {
      topics.Write(
          fix, time,
          RosNavSatFix(fixes->At(frame.world_from_optical.translation, {time, kCameraFrame})));
    }
    if (sequence != nullptr) {
      const cv::Mat pixels = ReadFrame(sequence, frame.index, input).image;
      topics.Write(
          image, time,
          RosCompressedImage({time, kOpticalFrame}, format, EncodeImage(scene.extension, pixels)));
    }
    if (progress && !progress(f + 1, count)) return;
  }
  topics.Commit();
}

}  // namespace orb360
