#pragma once

#include <string_view>

namespace orb360 {

/// The version of the library, as "0.1.0".
std::string_view Version();

}  // namespace orb360
