#pragma once

#include <filesystem>

namespace orb360::nn {

/// Returns the file of the network for depth completion that comes with the library. In an
/// installation it is share/orb360/weights beside the folder of the running program or under the
/// configured prefix; in a build it is weights/ in the sources. Throws UserError if there is none.
std::filesystem::path DefaultWeights();

}  // namespace orb360::nn
