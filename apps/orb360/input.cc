#include "apps/orb360/input.h"

#ifdef ORB360_HAS_TOWN
#include "apps/town/sequence/named_town.h"
#include "apps/town/sequence/town_source.h"
#else
#include <orb360/nn/base/check.h>
#endif

namespace orb360 {
namespace {

constexpr std::string_view kTownPrefix = "town:";

#ifdef ORB360_HAS_TOWN

std::unique_ptr<Sequence> OpenTown(const std::string& input, const SequenceOptions& options) {
  constexpr double kFps = 20.0;
  const town::TownSpec spec = town::FindTown(input.substr(kTownPrefix.size()));
  const bool has_size = !options.resize.empty();
  const cv::Size size = has_size ? options.resize : cv::Size(spec.width, spec.width / 2);
  town::Recording recording{EquirectangularCamera(size.width, size.height), kFps, spec.frames};
  recording.cube_size = has_size ? 0 : spec.cube_size;
  auto source = std::make_unique<town::TownSource>(input, spec, recording);
  return std::make_unique<Sequence>(std::move(source), options);
}

#else

std::unique_ptr<Sequence> OpenTown(const std::string& input, const SequenceOptions&) {
  throw UserError(input +
                  ": this orb360 was built without the renderer of towns; build it with "
                  "-DORB360_BUILD_TOWN=ON");
}

#endif

}  // namespace

bool IsRendered(const std::string& input) { return input.starts_with(kTownPrefix); }

std::unique_ptr<Sequence> OpenInput(const std::string& input, const SequenceOptions& options) {
  return IsRendered(input) ? OpenTown(input, options) : OpenSequence(input, options);
}

}  // namespace orb360
