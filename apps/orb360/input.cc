#include "apps/orb360/input.h"

#include "apps/town/sequence/named_town.h"
#include "apps/town/sequence/town_source.h"

namespace orb360 {
namespace {

constexpr std::string_view kTownPrefix = "town:";
constexpr double kTownFps = 20.0;
const cv::Size kTownSize(2048, 1024);

}  // namespace

bool IsRendered(const std::string& input) { return input.starts_with(kTownPrefix); }

std::unique_ptr<Sequence> OpenInput(const std::string& input, const SequenceOptions& options) {
  if (!IsRendered(input)) return OpenSequence(input, options);
  const cv::Size size = options.resize.empty() ? kTownSize : options.resize;
  const town::TownSpec spec = town::FindTown(input.substr(kTownPrefix.size()));
  const town::Recording recording{EquirectangularCamera(size.width, size.height), kTownFps,
                                  spec.frames};
  auto source = std::make_unique<town::TownSource>(input, spec, recording);
  return std::make_unique<Sequence>(std::move(source), options);
}

}  // namespace orb360
