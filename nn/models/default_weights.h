#pragma once

#include <filesystem>

namespace orb360::nn {

/// The network for depth completion that comes with the library: of an installation,
/// share/orb360/weights beside the folder of the running program or under the prefix it was
/// configured for; of a build, weights/ in the sources. Throws UserError where there is none.
std::filesystem::path DefaultWeights();

}  // namespace orb360::nn
