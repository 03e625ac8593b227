#pragma once

#include <string_view>

namespace orb360 {

/// The version of the library by `git describe`: that of a release, such as "0.1.0", or with the
/// commits since and the last of them, "0.1.0-12-g1a2b3c4d5"; "-dirty" for uncommitted changes.
std::string_view Version();

}  // namespace orb360
