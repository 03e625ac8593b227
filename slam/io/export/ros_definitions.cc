#include "slam/io/export/ros_definitions.h"

#include <algorithm>
#include <vector>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// A type of the ROS 2 interfaces (release Humble; later ones only add constants).
struct Definition {
  std::string_view name;               ///< `package/Type`.
  std::vector<std::string_view> uses;  ///< Types of its fields.
  std::string_view text;
};

const std::vector<Definition>& Definitions() {
  static const std::vector<Definition> kDefinitions = {
      {"builtin_interfaces/Time", {}, "int32 sec\nuint32 nanosec\n"},
      {"std_msgs/Header",
       {"builtin_interfaces/Time"},
       "builtin_interfaces/Time stamp\nstring frame_id\n"},
      {"geometry_msgs/Vector3", {}, "float64 x\nfloat64 y\nfloat64 z\n"},
      {"geometry_msgs/Point", {}, "float64 x\nfloat64 y\nfloat64 z\n"},
      {"geometry_msgs/Quaternion", {}, "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"},
      {"geometry_msgs/Transform",
       {"geometry_msgs/Vector3", "geometry_msgs/Quaternion"},
       "Vector3 translation\nQuaternion rotation\n"},
      {"geometry_msgs/TransformStamped",
       {"std_msgs/Header", "geometry_msgs/Transform"},
       "std_msgs/Header header\nstring child_frame_id\nTransform transform\n"},
      {"tf2_msgs/TFMessage",
       {"geometry_msgs/TransformStamped"},
       "geometry_msgs/TransformStamped[] transforms\n"},
      {"geometry_msgs/Pose",
       {"geometry_msgs/Point", "geometry_msgs/Quaternion"},
       "Point position\nQuaternion orientation\n"},
      {"geometry_msgs/PoseStamped",
       {"std_msgs/Header", "geometry_msgs/Pose"},
       "std_msgs/Header header\nPose pose\n"},
      {"nav_msgs/Path",
       {"std_msgs/Header", "geometry_msgs/PoseStamped"},
       "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"},
      {"sensor_msgs/CompressedImage",
       {"std_msgs/Header"},
       "std_msgs/Header header\nstring format\nuint8[] data\n"},
      {"sensor_msgs/PointField",
       {},
       "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\n"
       "uint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n"
       "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
      {"sensor_msgs/PointCloud2",
       {"std_msgs/Header", "sensor_msgs/PointField"},
       "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\n"
       "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n"},
      {"sensor_msgs/NavSatStatus",
       {},
       "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\n"
       "int8 STATUS_GBAS_FIX=2\nint8 status\n"
       "uint16 SERVICE_GPS=1\nuint16 SERVICE_GLONASS=2\nuint16 SERVICE_COMPASS=4\n"
       "uint16 SERVICE_GALILEO=8\nuint16 service\n"},
      {"sensor_msgs/NavSatFix",
       {"std_msgs/Header", "sensor_msgs/NavSatStatus"},
       "std_msgs/Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
       "float64 altitude\nfloat64[9] position_covariance\n"
       "uint8 COVARIANCE_TYPE_UNKNOWN=0\nuint8 COVARIANCE_TYPE_APPROXIMATED=1\n"
       "uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\nuint8 COVARIANCE_TYPE_KNOWN=3\n"
       "uint8 position_covariance_type\n"}};
  return kDefinitions;
}

const Definition& Find(std::string_view name) {
  const auto found = std::ranges::find(Definitions(), name, &Definition::name);
  ORB360_CHECK(found != Definitions().end(), name);
  return *found;
}

}  // namespace

std::string RosDefinition(std::string_view type) {
  constexpr std::string_view kMessages = "/msg/";
  const size_t at = type.find(kMessages);
  ORB360_CHECK(at != std::string_view::npos, type);
  const std::string name =
      std::string(type.substr(0, at)).append("/").append(type.substr(at + kMessages.size()));
  std::vector<std::string_view> names = {Find(name).name};  // each once, grows on the way
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) {
    const Definition& definition = Find(names[i]);
    if (i > 0) text.append(80, '=').append("\nMSG: ").append(names[i]).append("\n");
    text += definition.text;
    for (const std::string_view used : definition.uses) {
      if (std::ranges::find(names, used) == names.end()) names.push_back(used);
    }
  }
  return text;
}

}  // namespace orb360
