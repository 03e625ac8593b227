#pragma once

#include <filesystem>

#include "tests/nn/graph/network_builder.h"
#include "tests/slam/io/temp_folder.h"

namespace orb360 {

/// A network for depth completion without weights: spreads depth to the pixels around each point,
/// and the median everywhere else; sure of what has a point near.
inline std::filesystem::path WritePropagation(const TempFolder& folder) {
  nn::NetworkBuilder net(8);
  net.Input("depth", 1);
  net.Input("confidence", 1);
  net.Node("points", "median_log", {"depth", "confidence"}, nlohmann::json::object(), 3);
  net.NormalizedConvolution("mean", "points", "points.1", 1, 1, 3);
  net.weights[1].values = {0};
  net.Output("log_depth", "mean");
  net.Node("near", "affine", {"mean.1"}, {{"scale", 1e6}, {"offset", 0.0}});
  net.Node("sure", "clamp", {"near"}, {{"minimum", 0.0}, {"maximum", 0.9}});
  net.Output("confidence", "sure");
  net.Output("scale", "points.2");
  std::filesystem::path path = folder / "propagation.h5";
  net.Write(path);
  return path;
}

}  // namespace orb360
