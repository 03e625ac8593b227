#include "apps/orb360/input.h"

#include "apps/town/sequence/named_town.h"
#include "apps/town/sequence/town_source.h"

namespace orb360 {
namespace {

constexpr std::string_view kTownPrefix = "town:";
constexpr double kTownFps = 20.0;

}  // namespace

bool IsRendered(const std::string& input) { return input.starts_with(kTownPrefix); }

std::unique_ptr<Sequence> OpenInput(const std::string& input, const SequenceOptions& options) {
  if (!IsRendered(input)) return OpenSequence(input, options);
  const town::TownSpec spec = town::FindTown(input.substr(kTownPrefix.size()));
  const bool has_size = !options.resize.empty();
  const cv::Size size = has_size ? options.resize : cv::Size(spec.width, spec.width / 2);
  town::Recording recording{EquirectangularCamera(size.width, size.height), kTownFps, spec.frames};
  recording.cube_size = has_size ? 0 : spec.cube_size;
  auto source = std::make_unique<town::TownSource>(input, spec, recording);
  return std::make_unique<Sequence>(std::move(source), options);
}

}  // namespace orb360
