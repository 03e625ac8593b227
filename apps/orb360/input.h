#pragma once

#include <memory>
#include <string>

#include "slam/io/sequence.h"

namespace orb360 {

/// Whether an input is rendered, not read: `town:` and the name of a town (Town1 ... Town5, Loop)
/// or its seed. In its images nothing is fixed to the camera.
bool IsRendered(const std::string& input);

/// Opens what a user gives as INPUT: a rendered town, at 20 frames a second and the size of
/// options.resize, or at its own if that is empty; or whatever OpenSequence reads. Throws
/// UserError.
std::unique_ptr<Sequence> OpenInput(const std::string& input, const SequenceOptions& options);

}  // namespace orb360
