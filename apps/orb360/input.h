#pragma once

#include <memory>
#include <string>

#include <orb360/slam/io/sequence.h>

namespace orb360 {

/// Whether an input is rendered instead of read: `town:` and the name of a town (Town1 ... Town5,
/// Loop) or its seed. Its images show nothing that is fixed to the camera.
bool IsRendered(const std::string& input);

/// Opens the argument INPUT of a user: a rendered town, with 20 frames a second and the size
/// options.resize (the town's own size if that is empty), or anything that OpenSequence reads.
/// Throws UserError.
std::unique_ptr<Sequence> OpenInput(const std::string& input, const SequenceOptions& options);

}  // namespace orb360
