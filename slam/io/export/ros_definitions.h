#pragma once

#include <string>
#include <string_view>

namespace orb360 {

/// Returns the definition of a type of messages of ROS 2, such as "sensor_msgs/msg/NavSatFix", with
/// those of all types in it, as MCAP's encoding "ros2msg" wants them: after a line of 80 equals
/// signs and a line `MSG: package/Type`. Contract: it is one that ros_messages.h writes.
std::string RosDefinition(std::string_view type);

}  // namespace orb360
