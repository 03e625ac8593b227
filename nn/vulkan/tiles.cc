#include "nn/vulkan/tiles.h"

#include <algorithm>
#include <array>

namespace orb360::nn::vulkan {
namespace {

/// From large to small: 64 sums of an invocation fit into registers; 128 invocations are two to
/// four subgroups. The small ones are for the inner levels of a network, which have few pixels.
constexpr std::array<ConvolutionTile, kTileCount> kTiles = {
    ConvolutionTile{32, 4, 4, 4, 0}, ConvolutionTile{32, 4, 2, 4, 0},
    ConvolutionTile{16, 8, 1, 4, 0}, ConvolutionTile{16, 4, 1, 4, 0},
    ConvolutionTile{8, 8, 1, 2, 0},  ConvolutionTile{8, 4, 1, 1, 0},
};

/// Returns the number of workgroups that keep a device of this kind busy: a few for each of its
/// processors, of which graphics cards have up to some hundred and integrated ones some ten. These
/// numbers are estimates: they were not measured.
int EnoughGroups(VulkanDevice::Type device) {
  switch (device) {
    case VulkanDevice::Type::kIntegrated:
      return 64;
    case VulkanDevice::Type::kCpu:
      return 16;
    default:
      return 256;
  }
}

int Groups(const ConvolutionTile& tile, const Shape& output) {
  return GroupsFor(output.width, tile.width * tile.columns) *
         GroupsFor(output.height, tile.height) * GroupsFor(output.channels, 4 * tile.vectors);
}

/// A tile is not much larger than the output.
bool Fits(const ConvolutionTile& tile, const Shape& output) {
  return tile.width * tile.columns < 2 * output.width && tile.height < 2 * output.height &&
         4 * tile.vectors < 2 * std::max(output.channels, 3);
}

}  // namespace

ConvolutionTile ChooseTile(VulkanDevice::Type device, int kernel, int stride, int in_channels,
                           const Shape& output) {
  const auto* const found = std::ranges::find_if(kTiles, [&](const ConvolutionTile& tile) {
    return Fits(tile, output) && Groups(tile, output) >= EnoughGroups(device);
  });
  ConvolutionTile tile = found != kTiles.end() ? *found : kTiles.back();
  const int in_width = (tile.width * tile.columns - 1) * stride + kernel;
  const int in_height = (tile.height - 1) * stride + kernel;
  constexpr int kMaxChunk = 8;  // channels; beyond it, waiting for all invocations costs little
  const int room = kMaxSharedBytes / static_cast<int>(sizeof(float)) / (in_width * in_height);
  tile.chunk = std::clamp(std::min(room, in_channels), 1, kMaxChunk);
  return tile;
}

}  // namespace orb360::nn::vulkan
