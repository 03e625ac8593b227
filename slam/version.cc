#include "slam/version.h"

#include "version_text.h"

namespace orb360 {

std::string_view Version() { return ORB360_VERSION; }

}  // namespace orb360
