#include "version_text.h"
#include <orb360/slam/version.h>

namespace orb360 {

std::string_view Version() { return ORB360_VERSION; }

}  // namespace orb360
